// The fields of all cells.
import Cells from "../Cells.svelte";

export default {
  name: "fields",
  title: "Cells",
  place: "middle" as const,
  asks: ["cells"],
  view: Cells,
};
