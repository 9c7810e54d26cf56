import { defineConfig } from "vite";

// Builds one page that loads nothing from other servers. Old tablets in a lab support the build
// target.
export default defineConfig({
  base: "./",
  build: { target: "es2020", chunkSizeWarningLimit: 2000, assetsInlineLimit: 0 },
});
