import type { DescMethod } from '@bufbuild/protobuf';
import type { ServerLimits } from '@api/server_info_service_pb';

const KIB = 1024;
const MIB = 1024 * KIB;

/** The largest request of a method without a mesh or an image: a thousand digests as JSON fit. */
export const SMALL_BYTES = 256 * KIB;
/** What a message has beside a mesh or an image. */
const REQUEST_OVERHEAD = MIB;
/** One message of an upload. Two are under way at a time: one read, one sent. */
const CHUNK_MESSAGE_BYTES = MIB + 64 * KIB;

/** What the method's requests may hold beside small fields. */
function largePart(method: DescMethod, limits: ServerLimits): number {
  const mesh = Number(limits.maxInlineMeshBytes);
  const image = Number(limits.maxTextureBytes);
  switch (method.localName) {
    case 'createMesh':
      return mesh;
    case 'createJob':
      return image;
    case 'sample':
      return mesh + image;
    default:
      return 0;
  }
}

/** Whether requests of the method may be larger than SMALL_BYTES; others are refused unseen. */
export function mayBeLarge(method: DescMethod): boolean {
  return ['createMesh', 'createJob', 'sample'].includes(method.localName);
}

/** The largest request that the server takes of the method [byte], as it is encoded. */
export function serversLimit(method: DescMethod, limits: ServerLimits, isJson: boolean): number {
  const bytes = largePart(method, limits);
  // JSON has bytes as base64, four letters for three.
  return SMALL_BYTES + REQUEST_OVERHEAD + (isJson ? Math.ceil((bytes * 4) / 3) : bytes);
}

/** The largest message of the method that is read at all, whatever the server says [byte]. */
export function readLimit(method: DescMethod, maxMessageBytes: number): number {
  if (mayBeLarge(method)) return maxMessageBytes;
  return method.localName === 'uploadMesh' ? CHUNK_MESSAGE_BYTES : SMALL_BYTES;
}

/**
 * What a request may hold of memory while it is under way [byte]: what its header says, or as much
 * as is read where it says nothing.
 */
export function heldBytes(method: DescMethod, contentLength: number | undefined, maxMessageBytes: number): number {
  if (method.localName === 'uploadMesh') return 2 * CHUNK_MESSAGE_BYTES;
  return contentLength ?? readLimit(method, maxMessageBytes);
}
