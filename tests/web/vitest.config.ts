import { defineConfig } from 'vitest/config';
import { aliases } from '../../client/web/aliases';

export default defineConfig({
  resolve: { alias: aliases },
  test: {
    // Real servers and browsers share the machine with every other test.
    fileParallelism: false,
    testTimeout: 90_000,
    hookTimeout: 60_000,
    reporters: ['verbose'],
  },
});
