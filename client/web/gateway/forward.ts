import {
  create,
  type DescMethod,
  type DescMethodStreaming,
  type DescMethodUnary,
  type Message,
} from '@bufbuild/protobuf';
import { EmptySchema } from '@bufbuild/protobuf/wkt';
import {
  Code,
  ConnectError,
  type ConnectRouter,
  type HandlerContext,
  type MethodImpl,
  type Transport,
} from '@connectrpc/connect';
import { readLimit } from './limits';

// What callers may say to the server beside the message. Nothing else passes.
const FORWARDED_HEADERS = ['authorization', 'traceparent', 'tracestate'];

function forwardedHeaders(context: HandlerContext): Headers {
  const headers = new Headers();
  for (const name of FORWARDED_HEADERS) {
    const value = context.requestHeader.get(name);
    if (value !== null) headers.set(name, value);
  }
  return headers;
}

/** The server's error as it is, without the headers of its transport. */
function passedOn(error: unknown): ConnectError {
  const cause = ConnectError.from(error, Code.Unavailable);
  const copy = new ConnectError(cause.rawMessage, cause.code);
  copy.details = cause.details;
  return copy;
}

async function* one(message: Message): AsyncIterable<Message> {
  yield message;
}

async function* answers(
  transport: Transport,
  method: DescMethodStreaming,
  requests: AsyncIterable<Message>,
  context: HandlerContext,
): AsyncIterable<Message> {
  // What goes on in the form it came is not taken apart: as an empty message all of its fields are
  // unknown bytes, which are kept. Samples by the million pass at the price of a copy.
  const asItIs = !/json/.test(context.requestHeader.get('content-type') ?? '');
  try {
    const response = await transport.stream(
      asItIs ? { ...method, output: EmptySchema } : method,
      context.signal,
      context.timeoutMs(),
      forwardedHeaders(context),
      requests,
    );
    // One message at a time: a reader that is slow holds up the server's stream, not our memory.
    for await (const message of response.message) {
      if (!asItIs) yield message;
      else yield Object.assign(create(method.output), { $unknown: message.$unknown ?? [] });
    }
  } catch (error) {
    throw passedOn(error);
  }
}

async function answer(
  transport: Transport,
  method: DescMethodUnary,
  request: Message,
  context: HandlerContext,
): Promise<Message> {
  try {
    const response = await transport.unary(
      method,
      context.signal,
      context.timeoutMs(),
      forwardedHeaders(context),
      request,
    );
    return response.message;
  } catch (error) {
    throw passedOn(error);
  }
}

async function only(messages: AsyncIterable<Message>): Promise<Message> {
  let last: Message | undefined;
  for await (const message of messages) last = message;
  if (last === undefined) throw new ConnectError('the server sent no answer', Code.Internal);
  return last;
}

function handler(transport: Transport, method: DescMethod): unknown {
  // TypeScript does not narrow a description by its kind.
  const streaming = method as DescMethodStreaming;
  switch (method.methodKind) {
    case 'unary':
      return (request: Message, context: HandlerContext) =>
        answer(transport, method as DescMethodUnary, request, context);
    case 'server_streaming':
      return (request: Message, context: HandlerContext) =>
        answers(transport, streaming, one(request), context);
    case 'client_streaming':
      return (requests: AsyncIterable<Message>, context: HandlerContext) =>
        only(answers(transport, streaming, requests, context));
    case 'bidi_streaming':
      return (requests: AsyncIterable<Message>, context: HandlerContext) =>
        answers(transport, streaming, requests, context);
  }
}

/**
 * Routes that hand each of `methods` to the server behind `transport`, with the caller's token,
 * deadline and cancellation, and its answers and errors back. No message of a caller may have more
 * than readLimit().
 */
export function forwardTo(transport: Transport, methods: DescMethod[], maxMessageBytes: number) {
  return (router: ConnectRouter): void => {
    for (const method of methods) {
      const readMaxBytes = readLimit(method, maxMessageBytes);
      router.rpc(method, handler(transport, method) as MethodImpl<DescMethod>, { readMaxBytes });
    }
  };
}
