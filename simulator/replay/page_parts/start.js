// Starts the player. `window.utak` is for whoever looks into a page with a browser's console.

rememberedTheme();
try {
  const episode = openEpisode(byId("episode").textContent.trim().split(/\s+/));
  window.utak = { episode, player: startPlayer(episode) };
  byId("status").textContent = "";
} catch (error) {
  byId("status").textContent = `This page is damaged: ${error.message}`;
}
