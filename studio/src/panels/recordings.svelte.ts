// The recordings that were chosen: they stay while another tab is open, and are read by the server.

import { studio } from "../state.svelte";

/** A file as it is sent: packed, for a message holds a mebibyte. */
interface Packed {
  name: string;
  gzip_base64: string;
}

// What the server unpacks of all files together, and what a message holds beside the design.
const LONGEST = 16 * 2 ** 20;
const MESSAGE = 900_000;
const MOST = 32;

const ADVICE = "Leave some out, export fewer samples a second, or use `stepwell lab compare`.";

/** How files are read: the keys of a recording.toml, which are options of `stepwell lab` too. */
export type Reading = Record<string, string | number>;

// What a name of a file ends with, if it is a recording.
const ENDINGS = /\.(csv|tsv|txt|raw|dat|asc|lvm|log|tra|xlsx|xls|ods)$|^recording\.toml$/i;

/** Whether a file is a recording, or says how recordings are read. */
export const isRecording = ({ name }: File): boolean => ENDINGS.test(name);

class Recordings {
  files = $state.raw<Packed[]>([]);
  reading = $state.raw<Reading>({});
  /** A line for each file that was not taken. */
  refused = $state.raw<string[]>([]);

  /** Takes files beside those that are here; one of the same name takes its place. */
  async add(chosen: Iterable<File>): Promise<void> {
    this.refused = [];
    for (const file of chosen) {
      const packed = file.size > LONGEST ? "" : await pack(file);
      // After the wait: others may have been added or left out meanwhile.
      const others = this.files.filter((one) => one.name !== file.name);
      const length = others.reduce((sum, one) => sum + one.gzip_base64.length, packed.length);
      if (file.size > LONGEST) {
        const size = (file.size / 2 ** 20).toFixed(0);
        this.refuse(`${file.name}: ${size} MiB, and at most 16 MiB can be taken. ${ADVICE}`);
      } else if (length > MESSAGE || others.length >= MOST) {
        this.refuse(`${file.name}: together the recordings are too large. ${ADVICE}`);
      } else this.files = [...others, { name: file.name, gzip_base64: packed }];
    }
    this.changed();
  }

  /** Leaves a file out again. */
  remove(name: string): void {
    this.files = this.files.filter((one) => one.name !== name);
    this.changed();
  }

  /** Sets one key of the reading; an empty value leaves the choice to the reader. */
  read(key: string, value: string | number): void {
    const { [key]: _, ...others } = this.reading;
    this.reading = value === "" ? others : { ...others, [key]: value };
    this.changed();
  }

  /** Leaves everything to the reader again. */
  reread(): void {
    this.reading = {};
    this.changed();
  }

  /** What the server is asked, beside the design. */
  get asked(): object | null {
    const { files, reading } = this;
    if (!files.length) return null;
    return Object.keys(reading).length ? { files, reading } : { files };
  }

  private refuse(line: string): void {
    this.refused = [...this.refused, line];
  }

  private changed(): void {
    studio.cancel("measured");
    studio.again("measured");
  }
}

async function pack(file: File): Promise<string> {
  const packed = file.stream().pipeThrough(new CompressionStream("gzip"));
  const blob = await new Response(packed).blob();
  return new Promise((done, failed) => {
    const reader = new FileReader();
    reader.onload = () => done((reader.result as string).split(",")[1] ?? "");
    reader.onerror = () => failed(reader.error);
    reader.readAsDataURL(blob);
  });
}

export const recordings = new Recordings();
