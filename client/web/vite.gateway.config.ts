import { defineConfig } from 'vite';
import { aliases } from './aliases';

/** The gateway as one file that needs nothing but Node. */
export default defineConfig({
  resolve: { alias: aliases },
  ssr: { noExternal: true },
  build: {
    ssr: 'gateway/main.ts',
    outDir: '../../dist/gateway',
    emptyOutDir: true,
    target: 'node18',
  },
});
