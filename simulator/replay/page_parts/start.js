// Starts the player. `window.utak` is for whoever looks into a page with a browser's console.

const MIN_IDLE = 4; // milliseconds that must be left of an idle time for a piece of work
const WAIT = 30; // milliseconds between pieces of work where a browser does not tell when it is idle

// Reads ahead, a small piece at a time, while nobody waits for the page. Seeking does not need it, but is faster after it.
function readAhead(episode) {
  const later = window.requestIdleCallback ? (call) => requestIdleCallback(call) : (call) => setTimeout(call, WAIT);
  const work = (idle) => {
    do {
      if (!episode.prepare()) { window.utak.ready = true; return; }
    } while (idle && idle.timeRemaining() > MIN_IDLE);
    later(work);
  };
  later(work);
}

rememberedTheme();
try {
  const episode = openEpisode(byId("episode").textContent.trim().split(/\s+/));
  window.utak = { episode, player: startPlayer(episode), ready: false };
  readAhead(episode);
  byId("status").textContent = "";
} catch (error) {
  byId("status").textContent = `This page is damaged: ${error.message}`;
}
