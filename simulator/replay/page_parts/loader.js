// Inflates the player and runs it. The policy of the page allows just this script.

window.unpacked = unpacked;
const player = document.createElement("script");
player.textContent = unpacked(document.getElementById("player").textContent.trim());
document.body.append(player);
