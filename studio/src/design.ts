// A design as the file has it, and how it is edited: every edit makes a new one.

export type Point = [number, number];
export type Anchor = "p" | "q";

/** The anchors of one band. */
export interface BandTable {
  p_mm?: Point;
  q_mm?: Point;
  [key: string]: unknown;
}

/** One cell of a chain; elements hold a key of their own, such as "dome". */
export interface CellTable extends BandTable {
  name?: string;
  bands?: BandTable[];
}

/** A chain, of its own or of a leg. */
export interface ChainTable {
  cell?: CellTable[];
  [key: string]: unknown;
}

/** A design file: the same tables and keys, mm and degrees. */
export interface Design {
  title?: string;
  chain?: ChainTable;
  /** Robots have them. */
  leg?: { name?: string; chain?: ChainTable; [key: string]: unknown }[];
  [key: string]: unknown;
}

/** Where an anchor is: its cell, its band there (0 where there is one), and which end. */
export interface Place {
  cell: number;
  band: number;
  anchor: Anchor;
}

export const isRobot = (design: Design | null): boolean => Array.isArray(design?.leg);

/** The key of the chain that a leg has: its own, or the one that all legs share. */
export const chainKey = (design: Design | null, leg: number): string =>
  design?.leg?.[leg]?.chain?.cell ? `leg[${leg}].chain` : "chain";

/** The cells of the chain, or of one leg's. */
export const cellsOf = (design: Design | null, leg: number): CellTable[] =>
  design?.leg?.[leg]?.chain?.cell ?? design?.chain?.cell ?? [];

/** The same design with other cells. */
export function withCells(design: Design, leg: number, cell: CellTable[]): Design {
  if (!design.leg?.[leg]?.chain?.cell) return { ...design, chain: { ...design.chain, cell } };
  const legs = design.leg.map((one, k) =>
    k === leg ? { ...one, chain: { ...one.chain, cell } } : one,
  );
  return { ...design, leg: legs };
}

/** The same design with another chain, or of a robot with another chain of that leg. */
export function withChain(design: Design, leg: number, chain: ChainTable): Design {
  if (!design.leg?.[leg]?.chain?.cell) return { ...design, chain };
  return { ...design, leg: design.leg.map((one, k) => (k === leg ? { ...one, chain } : one)) };
}

export const nameOf = (cell: CellTable | undefined, i: number): string =>
  typeof cell?.name === "string" && cell.name ? cell.name : `cell ${i + 1}`;

/** The bands of a cell of levers; none of an element. */
export const bandsOf = (cell: CellTable | undefined): BandTable[] =>
  Array.isArray(cell?.bands) ? cell.bands : cell?.p_mm || cell?.q_mm ? [cell] : [];

const key = (anchor: Anchor): "p_mm" | "q_mm" => (anchor === "p" ? "p_mm" : "q_mm");

export const anchorOf = (cell: CellTable | undefined, band: number, anchor: Anchor): Point | undefined => {
  const point = bandsOf(cell)[band]?.[key(anchor)];
  return Array.isArray(point) && point.length === 2 ? point : undefined;
};

/** The anchors of all cells, the innermost first. */
export const placesOf = (cells: CellTable[]): Place[] =>
  cells.flatMap((cell, i) =>
    bandsOf(cell).flatMap((_, band) =>
      (["p", "q"] as const)
        .filter((anchor) => anchorOf(cell, band, anchor))
        .map((anchor) => ({ cell: i, band, anchor })),
    ),
  );

/** The name of an anchor for people. */
export function labelOf(cells: CellTable[], { cell, band, anchor }: Place): string {
  const name = nameOf(cells[cell], cell);
  return bandsOf(cells[cell]).length > 1
    ? `${anchor} of band ${band + 1} of ${name}`
    : `${anchor} of ${name}`;
}

/** The key of an anchor as messages name it. */
export function keyOf(chain: string, cells: CellTable[], { cell, band, anchor }: Place): string {
  const own = Array.isArray(cells[cell]?.bands) ? `.bands[${band}]` : "";
  return `${chain}.cell[${cell}]${own}.${key(anchor)}`;
}

/** The same cells with one of them changed. */
export const withCell = (cells: CellTable[], i: number, changed: CellTable): CellTable[] =>
  cells.map((cell, j) => (j === i ? changed : cell));

/** The same cells with one anchor elsewhere. */
export function withAnchor(cells: CellTable[], place: Place, point: Point): CellTable[] {
  const cell = cells[place.cell];
  const moved = { [key(place.anchor)]: point };
  if (!Array.isArray(cell.bands)) return withCell(cells, place.cell, { ...cell, ...moved });
  const bands = cell.bands.map((band, k) => (k === place.band ? { ...band, ...moved } : band));
  return withCell(cells, place.cell, { ...cell, bands });
}

/** One more cell at the outer end, like the one before it but for its place. */
export function withCellAdded(cells: CellTable[]): CellTable[] {
  const model = cells.at(-1) ?? { p_mm: [-10, 0], q_mm: [10, 0] };
  const names = new Set(cells.map(nameOf));
  let number = cells.length + 1;
  while (names.has(`cell ${number}`)) number += 1;
  const added: CellTable = { ...model, name: `cell ${number}` };
  // Two equal cells tie, and then friction decides.
  if (model.q_mm) added.q_mm = [round(model.q_mm[0] + 2.5), model.q_mm[1]];
  return [...cells, added];
}

/** Without one cell. */
export const withoutCell = (cells: CellTable[], i: number): CellTable[] =>
  cells.filter((_, j) => j !== i);

/** With a cell and its outer neighbour in each other's place. */
export function withCellsSwapped(cells: CellTable[], i: number): CellTable[] {
  const swapped = [...cells];
  [swapped[i], swapped[i + 1]] = [cells[i + 1], cells[i]];
  return swapped;
}

/** With a cell mirrored along the stroke, so that its two stops change places. */
export function withCellMirrored(cells: CellTable[], i: number): CellTable[] {
  return placesOf(cells)
    .filter((place) => place.cell === i)
    .reduce((all, place) => {
      const [x, y] = anchorOf(all[i], place.band, place.anchor)!;
      return withAnchor(all, place, [x, 0 - y]);
    }, cells);
}

/** To a hundredth of a millimetre, which is finer than any hole is drilled. */
export const round = (mm: number): number => Math.round(mm * 100) / 100 + 0;

/** A number for a reader: as many digits as can be told apart on a bench. */
export function told(value: number | null | undefined, digits = 4): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const short = Number(value.toPrecision(digits));
  return (Object.is(short, -0) ? 0 : short).toString().replace("-", "−");
}

/** A design in the address: base64 without what an address would escape. */
export function toHash(design: Design): string {
  const bytes = new TextEncoder().encode(JSON.stringify(design));
  const text = btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
  return text.replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

/** The design that an address holds; null where it holds none. */
export function fromHash(hash: string): Design | null {
  const text = /[#&]design=([\w-]+)/.exec(hash)?.[1];
  if (!text) return null;
  try {
    const bytes = atob(text.replaceAll("-", "+").replaceAll("_", "/"));
    const json = new TextDecoder().decode(Uint8Array.from(bytes, (one) => one.charCodeAt(0)));
    return designIn(json);
  } catch {
    return null;
  }
}

/** The design that JSON holds; null where it is none. */
export function designIn(json: string | null): Design | null {
  try {
    const found: unknown = JSON.parse(json ?? "null");
    const design = found as Design | null;
    return Array.isArray(design?.chain?.cell) || isRobot(design) ? design : null;
  } catch {
    return null;
  }
}
