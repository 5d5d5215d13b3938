// A design as the file has it, and how it is edited: every edit makes a new one.

export type Point = [number, number];
export type Anchor = "p" | "q";

/** One cell of a chain; elements hold a key of their own, such as "dome". */
export interface CellTable {
  name?: string;
  p_mm?: Point;
  q_mm?: Point;
  [key: string]: unknown;
}

/** A design file: the same tables and keys, mm and degrees. */
export interface Design {
  title?: string;
  chain?: { cell: CellTable[]; [key: string]: unknown };
  [key: string]: unknown;
}

export const cellsOf = (design: Design | null): CellTable[] => design?.chain?.cell ?? [];

export const nameOf = (cell: CellTable | undefined, i: number): string =>
  typeof cell?.name === "string" && cell.name ? cell.name : `cell ${i + 1}`;

const key = (anchor: Anchor): "p_mm" | "q_mm" => (anchor === "p" ? "p_mm" : "q_mm");

export const anchorOf = (cell: CellTable | undefined, anchor: Anchor): Point | undefined => {
  const point = cell?.[key(anchor)];
  return Array.isArray(point) && point.length === 2 ? point : undefined;
};

/** The key of an anchor as messages name it. */
export const placeOf = (i: number, anchor: Anchor): string => `chain.cell[${i}].${key(anchor)}`;

/** The same design with other cells. */
export function withCells(design: Design, cells: CellTable[]): Design {
  return { ...design, chain: { ...design.chain, cell: cells } };
}

/** The same design with one anchor elsewhere. */
export function withAnchor(design: Design, i: number, anchor: Anchor, point: Point): Design {
  return withCells(
    design,
    cellsOf(design).map((cell, j) => (j === i ? { ...cell, [key(anchor)]: point } : cell)),
  );
}

/** One more cell at the outer end, like the one before it but for its place. */
export function withCellAdded(design: Design): Design {
  const cells = cellsOf(design);
  const model = cells.at(-1) ?? { p_mm: [-10, 0], q_mm: [10, 0] };
  const names = new Set(cells.map(nameOf));
  let number = cells.length + 1;
  while (names.has(`cell ${number}`)) number += 1;
  const added: CellTable = { ...model, name: `cell ${number}` };
  // Two equal cells tie, and then friction decides.
  if (model.q_mm) added.q_mm = [round(model.q_mm[0] + 2.5), model.q_mm[1]];
  return withCells(design, [...cells, added]);
}

/** Without one cell. */
export function withoutCell(design: Design, i: number): Design {
  return withCells(
    design,
    cellsOf(design).filter((_, j) => j !== i),
  );
}

/** With a cell and its outer neighbour in each other's place. */
export function withCellsSwapped(design: Design, i: number): Design {
  const cells = [...cellsOf(design)];
  [cells[i], cells[i + 1]] = [cells[i + 1], cells[i]];
  return withCells(design, cells);
}

/** With a cell mirrored along the stroke, so that its two stops change places. */
export function withCellMirrored(design: Design, i: number): Design {
  const flip = (point?: Point): Point | undefined => point && [point[0], 0 - point[1]];
  return withCells(
    design,
    cellsOf(design).map((cell, j) =>
      j === i ? { ...cell, p_mm: flip(cell.p_mm), q_mm: flip(cell.q_mm) } : cell,
    ),
  );
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
    const chain = (found as Design | null)?.chain;
    return Array.isArray(chain?.cell) ? (found as Design) : null;
  } catch {
    return null;
  }
}
