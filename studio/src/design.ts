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

/** The table that holds the cells. */
export const chainOf = (design: Design | null, leg: number): ChainTable =>
  (design?.leg?.[leg]?.chain?.cell ? design.leg[leg].chain : design?.chain) ?? {};

/** The same design with another table there. */
export function withChain(design: Design, leg: number, chain: ChainTable): Design {
  if (!design.leg?.[leg]?.chain?.cell) return { ...design, chain };
  const legs = design.leg.map((one, k) => (k === leg ? { ...one, chain } : one));
  return { ...design, leg: legs };
}

/** The same design with other cells. */
export const withCells = (design: Design, leg: number, cell: CellTable[]): Design =>
  withChain(design, leg, { ...chainOf(design, leg), cell });

/** Keys, and places in lists, from a table on. */
export type Path = (string | number)[];

/** What a table holds there; undefined where it is left out. */
export const valueAt = (table: unknown, path: Path): unknown =>
  path.reduce((at, step) => (at as Record<string | number, unknown> | undefined)?.[step], table);

/** The same table with a value there, or without the key, and without tables that leaves empty. */
export function withValue<T>(table: T, path: Path, value: unknown): T {
  const [step, ...rest] = path;
  if (Array.isArray(table)) {
    return table.map((one, k) => (k === step ? withValue(one, rest, value) : one)) as T;
  }
  const all: Record<string, unknown> = { ...(table as object) };
  const inner = rest.length ? withValue(all[step] ?? {}, rest, value) : value;
  const empty = value === undefined && rest.length === 1 && step === "band";
  if (inner === undefined || (empty && !Object.keys(inner as object).length)) delete all[step];
  else all[step] = inner;
  return all as T;
}

/** The name of a key as messages spell it. */
export const spelled = (path: Path): string =>
  path.map((step) => (typeof step === "number" ? `[${step}]` : `.${step}`)).join("");

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
export function labelOf(of: CellTable, { cell, band, anchor }: Place): string {
  const name = nameOf(of, cell);
  return bandsOf(of).length > 1
    ? `${anchor} of band ${band + 1} of ${name}`
    : `${anchor} of ${name}`;
}

/** What tells an anchor from all others, though cells are reordered and bands are added. */
export const lockOf = (chain: string, of: CellTable, { cell, band, anchor }: Place): string =>
  `${chain} ${nameOf(of, cell)} ${band} ${anchor}`;

/** The key of an anchor as messages name it. */
export function keyOf(chain: string, of: CellTable, { cell, band, anchor }: Place): string {
  const own = Array.isArray(of.bands) ? `.bands[${band}]` : "";
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

/** The same cells with one more band on one of them, beside its last. */
export function withBandAdded(cells: CellTable[], i: number): CellTable[] {
  const { p_mm, q_mm, ...rest } = cells[i];
  const bands = bandsOf(cells[i]).map((band) => (band === cells[i] ? { p_mm, q_mm } : band));
  const [like] = bands.slice(-1);
  // Beside the one it is like, so that both can be seen.
  const q: Point = like.q_mm ? [like.q_mm[0], round(like.q_mm[1] + 2.5)] : [10, 0];
  return withCell(cells, i, { ...rest, bands: [...bands, { ...like, q_mm: q }] });
}

/** The same cells without a band of one of them; of two, the other has the cell to itself. */
export function withoutBand(cells: CellTable[], i: number, band: number): CellTable[] {
  const { bands = [], ...rest } = cells[i];
  const left = bands.filter((_, k) => k !== band);
  if (left.length > 1) return withCell(cells, i, { ...rest, bands: left });
  const { p_mm, q_mm, ...own } = left[0];
  const both = { ...(rest.band as object | undefined), ...own };
  const cell: CellTable = { ...rest, p_mm, q_mm };
  if (Object.keys(both).length) cell.band = both;
  return withCell(cells, i, cell);
}

/** One more cell at the outer end: of a kind, or like the one before it but for its place. */
export function withCellAdded(cells: CellTable[], kind?: CellTable): CellTable[] {
  const model = kind ?? cells.at(-1) ?? { p_mm: [-10, 0], q_mm: [10, 0] };
  const names = new Set(cells.map(nameOf));
  let number = cells.length + 1;
  while (names.has(`cell ${number}`)) number += 1;
  const added: CellTable = { ...model, name: `cell ${number}` };
  // Two equal cells tie, and then friction decides.
  if (model.q_mm && !kind) added.q_mm = [round(model.q_mm[0] + 2.5), model.q_mm[1]];
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

/** A number for a reader: as many digits as can be measured on a bench. */
export function formatted(value: number | null | undefined, digits = 4): string {
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

/** The design that JSON holds; null if it has another structure. */
export function designIn(json: string | null): Design | null {
  try {
    const value: unknown = JSON.parse(json ?? "null");
    return isDesign(value) ? value : null;
  } catch {
    return null;
  }
}

const isTable = (value: unknown): value is Record<string, unknown> =>
  typeof value === "object" && value !== null && !Array.isArray(value);

const isChain = (value: unknown): boolean =>
  isTable(value) && Array.isArray(value.cell) && value.cell.length > 0 && value.cell.every(isCell);

const isCell = (value: unknown): boolean =>
  isTable(value) &&
  (value.bands === undefined || (Array.isArray(value.bands) && value.bands.every(isTable)));

function isDesign(value: unknown): value is Design {
  if (!isTable(value) || !["undefined", "string"].includes(typeof value.title)) return false;
  const { leg, chain } = value;
  if (leg === undefined) return isChain(chain);
  // All legs may share one chain.
  const own = (one: unknown): boolean => isTable(one) && (isChain(one.chain) || isChain(chain));
  return Array.isArray(leg) && leg.length > 0 && leg.every(own);
}
