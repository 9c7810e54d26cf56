import { defineConfig } from "vite";

// One page that loads nothing from other servers. The target is old enough for tablets in a lab.
export default defineConfig({
  base: "./",
  build: { target: "es2020", chunkSizeWarningLimit: 2000, assetsInlineLimit: 0 },
});
