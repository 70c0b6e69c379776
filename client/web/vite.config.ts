import { defineConfig } from 'vite';
import { aliases } from './aliases';

export default defineConfig({
  base: '/',
  resolve: { alias: aliases },
  build: {
    outDir: '../../dist/page',
    emptyOutDir: true,
    target: 'es2022',
    // The strict content security policy has no room for data: addresses.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    // Draco's WebAssembly and three.js are large by nature; tests/web holds the sum to a limit.
    chunkSizeWarningLimit: 1000,
    rollupOptions: {
      output: { manualChunks: { three: ['three'] } },
    },
  },
  worker: { format: 'es' },
});
