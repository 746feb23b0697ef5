// Inflates the player and the episode, and starts. The policy of the page allows just this style and these scripts.

const element = (id) => document.getElementById(id);
const state = (word) => { document.documentElement.dataset.state = word; };

// The text that was deflated (zlib) and written in base 64.
async function inflated(id) {
  const bytes = Uint8Array.from(atob(element(id).textContent.trim()), (sign) => sign.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).text();
}

(async () => {
  if (!window.DecompressionStream) throw new Error("this browser cannot inflate it; one of 2023 or later can");
  const parts = JSON.parse(await inflated("player"));
  document.body.insertAdjacentHTML("afterbegin", parts.body);
  for (const [name, place] of [["style", document.head], ["script", document.body]]) {
    const made = document.createElement(name);
    made.textContent = parts[name];
    place.append(made);
  }
  window.utak.start(await inflated("episode"));
  state("ready");
})().catch((error) => {
  (element("status") || document.body.appendChild(document.createElement("p"))).textContent = `This page cannot be shown, or is damaged: ${error.message}`;
  state("damaged");
});
