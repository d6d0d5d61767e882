// Plants that can be drawn, by their name; a plant without a scene has its plots.

const scenes = {
  cartpole: (episode, width) => cartpoleScene(episode, width),
  quadrotor: (episode, width) => quadrotorScene(episode, width),
};

function sceneOf(episode) {
  return Object.hasOwn(scenes, episode.plant) ? scenes[episode.plant] : null;
}
