import type { DecoderModule, EncoderModule } from 'draco3d';
import createDecoder from 'draco3d/draco_decoder_nodejs.js';
import decoderWasm from 'draco3d/draco_decoder.wasm?url';
import createEncoder from 'draco3d/draco_encoder_nodejs.js';
import encoderWasm from 'draco3d/draco_encoder.wasm?url';

let decoder: Promise<DecoderModule> | undefined;
let encoder: Promise<EncoderModule> | undefined;

async function load(address: string): Promise<ArrayBuffer> {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`${address}: ${response.status}`);
  return response.arrayBuffer();
}

/** Draco's decoder, loaded the first time it is needed. */
export function decoderModule(): Promise<DecoderModule> {
  decoder ??= load(decoderWasm).then((wasmBinary) => createDecoder({ wasmBinary }));
  return decoder;
}

/** Draco's encoder, loaded the first time it is needed. */
export function encoderModule(): Promise<EncoderModule> {
  encoder ??= load(encoderWasm).then((wasmBinary) => createEncoder({ wasmBinary }));
  return encoder;
}
