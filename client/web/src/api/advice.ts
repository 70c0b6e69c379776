import { Code } from '@connectrpc/connect';

/** What happened, and what to do. */
export interface Advice {
  title: string;
  advice: string;
}

/** For each reason of proto/docs/errors.md; a test holds the two lists together. */
export const ADVICE_BY_REASON: Record<string, Advice> = {
  REQUEST_INVALID: {
    title: 'The request is not complete',
    advice: 'Correct what is named below and start again.',
  },
  OPTION_INVALID: {
    title: 'An option is out of its range',
    advice: 'Correct the option named below and start again.',
  },
  LIMIT_EXCEEDED: {
    title: 'Larger than this server takes',
    advice: 'Ask for fewer samples, or reduce the mesh; who runs the server can raise the limit.',
  },
  MESH_UNREADABLE: {
    title: 'The file cannot be read',
    advice: 'Export it again as OBJ, PLY, STL, OFF or GLB, and check that its name ends accordingly.',
  },
  DRACO_DECODE_FAILED: {
    title: 'Not a Draco mesh',
    advice: 'The file is damaged or of another kind. Export it again, or drop it in another format.',
  },
  MESH_EMPTY: {
    title: 'The mesh has no surface',
    advice: 'It needs at least one triangle with an area; point clouds cannot be sampled.',
  },
  MESH_DEGENERATE: {
    title: 'The mesh has broken numbers',
    advice: 'A coordinate is not a number or an index leads nowhere; the place is named below.',
  },
  IMAGE_UNREADABLE: {
    title: 'The image cannot be read',
    advice: 'Choose a PNG or JPEG.',
  },
  DENSITY_INVALID: {
    title: 'The density cannot be used',
    advice: 'It must be finite, nowhere negative and somewhere positive, and the mesh must carry it.',
  },
  COUNT_TOO_SMALL: {
    title: 'Too few samples for this shape',
    advice: 'Ask for at least as many as named below, or use a method that makes no mesh.',
  },
  MESH_NOT_MANIFOLD: {
    title: 'The mesh is not a surface',
    advice: 'Repair the place named below, or join near vertices with the weld tolerance.',
  },
  DIGEST_MISMATCH: {
    title: 'The upload was damaged on its way',
    advice: 'Start again; the file will be sent anew.',
  },
  CHUNK_OFFSET_MISMATCH: {
    title: 'The upload arrived out of order',
    advice: 'Start again; the file will be sent anew.',
  },
  MESH_MISSING: {
    title: 'The server no longer has the mesh',
    advice: 'Drop the file again and start the job from it.',
  },
  MESH_IN_USE: {
    title: 'A job still needs the mesh',
    advice: 'Wait until the job has ended, or cancel it.',
  },
  JOB_NOT_ENDED: {
    title: 'The job is not finished',
    advice: 'Wait until it has ended, or cancel it.',
  },
  JOB_HAS_NO_SAMPLES: {
    title: 'The job left no samples',
    advice: 'It failed or was cancelled. Start it again from its options.',
  },
  NOT_FOUND: {
    title: 'Not there',
    advice: 'It was deleted, its time is over, or it belongs to somebody else.',
  },
  QUOTA_EXCEEDED: {
    title: 'Your share of the server is used up',
    advice: 'Wait for jobs to end, or delete jobs and meshes you no longer need.',
  },
  STORAGE_FULL: {
    title: "The server's disk is full",
    advice: 'Delete jobs you no longer need, or tell who runs the server; nothing stored is lost.',
  },
  STORAGE_FAILED: {
    title: 'The server cannot read what it stored',
    advice: 'Tell who runs the server; the message below names the part.',
  },
  UNAUTHENTICATED: {
    title: 'The server asks for a token',
    advice: 'Enter a valid one with “Token” above; who runs the server hands them out.',
  },
  PERMISSION_DENIED: {
    title: 'The token does not allow this',
    advice: 'A read-only token may look, not sample. Enter another one with “Token” above.',
  },
  QUEUE_FULL: {
    title: 'The server is busy',
    advice: 'Its queue is full just now. Try again in a moment.',
  },
  OUT_OF_MEMORY: {
    title: 'The computation needs more memory than there is',
    advice: 'Ask for fewer samples or reduce the mesh.',
  },
  TIME_LIMIT_EXCEEDED: {
    title: 'There was not enough time',
    advice:
      'The time limit passed before there were samples. Allow more time, ask for fewer samples, or reduce the mesh.',
  },
  DRAINING: {
    title: 'The server is going away',
    advice: 'It takes no new jobs; stored ones go on when it is back. The page reconnects by itself.',
  },
  CANCELLED: {
    title: 'Cancelled',
    advice: 'Start it again if that was not intended.',
  },
  INTERNAL: {
    title: 'A fault of the program',
    advice: 'Please report it with the message below.',
  },
};

/** Where an error carries no reason: what gRPC, the gateway or the browser raise. */
export const ADVICE_BY_CODE: Partial<Record<Code, Advice>> = {
  [Code.Unavailable]: {
    title: 'The server cannot be reached',
    advice: 'Check that ccst-server and the gateway run. The page tries again by itself.',
  },
  [Code.DeadlineExceeded]: {
    title: 'The server did not answer in time',
    advice: 'Try again; it may be busy.',
  },
  [Code.ResourceExhausted]: {
    title: 'Too large for one request',
    advice: 'Reduce the mesh, or send it with the command: ccst upload FILE.',
  },
  [Code.Canceled]: { title: 'Cancelled', advice: 'Try again if that was not intended.' },
  [Code.Unimplemented]: {
    title: 'The server does not know this call',
    advice: 'It is older than this page. Update it.',
  },
  [Code.Internal]: {
    title: 'The answer broke off',
    advice: 'The connection was cut in the middle. Try again.',
  },
  [Code.Unknown]: {
    title: 'The connection broke',
    advice: 'Check that the server and the gateway run, and try again.',
  },
};
