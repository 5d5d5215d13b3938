// Builds the page of the studio into the Python package, under names that never change, and
// beside it the script and the styles of a replay, which stand in a page of their own.
import { svelte } from "@sveltejs/vite-plugin-svelte";
import { type Plugin, build, defineConfig } from "vite";

// A replay is opened from a folder or a mail, where no module can be loaded: all in one script.
function replay(): Plugin {
  let into = "";
  return {
    name: "replay",
    configResolved: ({ build: { outDir } }) => {
      into = outDir;
    },
    closeBundle: async () => {
      await build({
        configFile: false,
        plugins: [svelte()],
        publicDir: false,
        build: {
          outDir: into,
          emptyOutDir: false,
          modulePreload: false,
          cssCodeSplit: false,
          rollupOptions: {
            input: "src/replay.ts",
            output: {
              format: "iife",
              entryFileNames: "replay.js",
              assetFileNames: "replay[extname]",
            },
          },
        },
      });
    },
  };
}

export default defineConfig({
  plugins: [svelte(), replay()],
  base: "/",
  build: {
    outDir: "../src/stepwell/studio/page",
    emptyOutDir: true,
    modulePreload: false,
    cssCodeSplit: false,
    assetsInlineLimit: 0,
    rollupOptions: {
      output: {
        entryFileNames: "studio.js",
        chunkFileNames: "[name].js",
        assetFileNames: "studio[extname]",
      },
    },
  },
});
