// What statics says that a robot will do.
import Prediction from "./Prediction.svelte";

export default {
  name: "prediction",
  title: "Prediction",
  place: "robot" as const,
  follows: { type: "predict", long: true },
  view: Prediction,
};
