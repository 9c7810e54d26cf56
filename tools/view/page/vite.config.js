import { defineConfig } from "vite";

// One page without anything from elsewhere; old enough a target for a lab's tablets.
export default defineConfig({
  base: "./",
  build: { target: "es2020", chunkSizeWarningLimit: 2000, assetsInlineLimit: 0 },
});
