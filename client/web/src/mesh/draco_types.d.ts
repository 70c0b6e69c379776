declare module 'draco3d/draco_decoder_nodejs.js' {
  import type { DecoderModule } from 'draco3d';
  export default function create(options: { wasmBinary: ArrayBuffer }): Promise<DecoderModule>;
}

declare module 'draco3d/draco_encoder_nodejs.js' {
  import type { EncoderModule } from 'draco3d';
  export default function create(options: { wasmBinary: ArrayBuffer }): Promise<EncoderModule>;
}
