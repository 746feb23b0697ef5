// Expands the player and runs it. The policy of the page allows just this style and this script.

Object.assign(window, { unpacked, unpacking });
const [parts] = unpacked(document.getElementById("player").textContent.trim());
for (const [name, place] of [["style", document.head], ["script", document.body]]) {
  if (name === "script") document.body.insertAdjacentHTML("afterbegin", parts.body);
  const element = document.createElement(name);
  element.textContent = parts[name];
  place.append(element);
}
