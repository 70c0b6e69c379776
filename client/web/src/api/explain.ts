import { fromBinary } from '@bufbuild/protobuf';
import { Code, ConnectError } from '@connectrpc/connect';
import {
  ErrorInfoSchema,
  FieldViolationsSchema,
  RetryAdviceSchema,
  type Status,
} from '@api/error_pb';
import { ADVICE_BY_CODE, ADVICE_BY_REASON, type Advice } from './advice';

/** An error of the API in words. */
export interface Explanation extends Advice {
  /** What the server said, which names what was wrong and where. */
  detail: string;
  /** The ErrorInfo's reason, or the name of the code where there is none. */
  reason: string;
  /** Wrong fields of the request with what would be right. */
  violations: { field: string; description: string }[];
  /** Whether the same call may go well later without a change. */
  transient: boolean;
  /** Least time to wait before trying again, in milliseconds. */
  retryAfterMs: number;
}

const TRANSIENT = [
  Code.Unavailable,
  Code.DeadlineExceeded,
  Code.ResourceExhausted,
  // What a stream ends with whose server or proxy died in the middle.
  Code.Internal,
  Code.Unknown,
  Code.Aborted,
];

function milliseconds(delay: { seconds: bigint; nanos: number } | undefined): number {
  return delay ? Number(delay.seconds) * 1000 + delay.nanos / 1e6 : 0;
}

/** Explains what a call threw, also when it was no answer of the API. */
export function explain(error: unknown): Explanation {
  const cause = ConnectError.from(error, Code.Unavailable);
  const reason = cause.findDetails(ErrorInfoSchema)[0]?.reason ?? '';
  const retry = cause.findDetails(RetryAdviceSchema)[0];
  const violations = cause.findDetails(FieldViolationsSchema)[0]?.fieldViolations ?? [];
  return {
    ...adviceFor(reason, cause.code),
    detail: cause.rawMessage,
    reason: reason || Code[cause.code],
    violations: violations.map(({ field, description }) => ({ field, description })),
    // A reason says that the server meant it; without one the connection broke.
    transient: TRANSIENT.includes(cause.code) && !['INTERNAL', 'STORAGE_FAILED'].includes(reason),
    retryAfterMs: milliseconds(retry?.retryDelay),
  };
}

/** Explains the error of a failed job. */
export function explainStatus(status: Status): Explanation {
  let reason = '';
  let violations: Explanation['violations'] = [];
  for (const { typeUrl, value } of status.details) {
    if (typeUrl.endsWith('/' + ErrorInfoSchema.typeName)) {
      reason = fromBinary(ErrorInfoSchema, value).reason;
    } else if (typeUrl.endsWith('/' + FieldViolationsSchema.typeName)) {
      violations = fromBinary(FieldViolationsSchema, value).fieldViolations;
    }
  }
  return {
    ...adviceFor(reason, status.code),
    detail: status.message,
    reason: reason || (Code[status.code] ?? 'Unknown'),
    violations: violations.map(({ field, description }) => ({ field, description })),
    transient: false,
    retryAfterMs: 0,
  };
}

function adviceFor(reason: string, code: Code): Advice {
  return (
    ADVICE_BY_REASON[reason] ??
    ADVICE_BY_CODE[code] ?? {
      title: 'The server refused the call',
      advice: 'The message below says why. Try again; if it stays, ask who runs the server.',
    }
  );
}
