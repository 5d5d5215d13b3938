/** What a key does to a view in 3D: turn to the left and up [rad], and magnification. */
export const TURNS: Record<string, [number, number, number]> = {
  ArrowLeft: [-0.15, 0, 1],
  ArrowRight: [0.15, 0, 1],
  ArrowUp: [0, 0.1, 1],
  ArrowDown: [0, -0.1, 1],
  "+": [0, 0, 1.2],
  "-": [0, 0, 1 / 1.2],
};
