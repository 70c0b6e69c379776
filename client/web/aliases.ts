import { fileURLToPath } from 'node:url';

const generated = fileURLToPath(new URL('../../generated', import.meta.url));

/** Where the code made from the protos is; tsconfig.json has the same names. */
export const aliases = {
  '@api': `${generated}/ccst/v1`,
  '@health': `${generated}/grpc/health/v1`,
};
