// Offers what starts the player. `window.utak` is for whoever looks into a page with a browser's console.

rememberedTheme();
window.utak = {
  start: (text) => {
    const episode = openEpisode(text);
    Object.assign(window.utak, { episode, player: startPlayer(episode) });
    byId("status").textContent = "";
  },
};
