import { create } from '@bufbuild/protobuf';
import { Code, ConnectError } from '@connectrpc/connect';
import { expect, test } from 'vitest';
import { ErrorInfoSchema, RetryAdviceSchema } from '@api/error_pb';
import { IterationProgressSchema, Job_State, JobSchema } from '@api/job_pb';
import { WatchJobResponseSchema, type WatchJobResponse } from '@api/sampling_service_pb';
import { JobWatch, type Connection } from '../../../client/web/src/job/job_watch';

const snapshot = (state: Job_State) =>
  create(WatchJobResponseSchema, { event: { case: 'snapshot', value: create(JobSchema, { state }) } });
const progress = (sequence: bigint) =>
  create(WatchJobResponseSchema, {
    sequence,
    event: {
      case: 'progress',
      value: create(IterationProgressSchema, { iteration: Number(sequence) }),
    },
  });
const running = snapshot(Job_State.RUNNING);
const succeeded = snapshot(Job_State.SUCCEEDED);
const cut = new ConnectError('connection lost', Code.Unavailable);

/** Runs a watch over scripted streams: each is messages, then maybe an error. */
async function follow(streams: (WatchJobResponse | Error)[][]) {
  const asked: bigint[] = [];
  const waits: number[] = [];
  const states: Connection['state'][] = [];
  const watch = new JobWatch(
    {
      async *open(afterSequence) {
        asked.push(afterSequence);
        for (const item of streams.shift() ?? [succeeded]) {
          if (item instanceof Error) throw item;
          yield item;
        }
      },
      wait: async (milliseconds) => void waits.push(milliseconds),
      random: () => 0,
    },
    {
      onJob: () => {},
      onProgress: () => {},
      onPreview: () => {},
      onConnection: ({ state }) => void states.push(state),
    },
  );
  await watch.run();
  return { asked, waits, states, history: watch.history };
}

test('JobWatch.Stream that ends with an ended job is not opened again', async () => {
  const { asked, states } = await follow([[running, progress(1n), succeeded]]);
  expect(asked).toEqual([0n]);
  expect(states).toEqual(['connecting', 'live', 'ended']);
});

test('JobWatch.Broken stream goes on after the last sequence', async () => {
  const { asked, history, states } = await follow([
    [running, progress(1n), progress(2n), cut],
    [running, progress(3n), succeeded],
  ]);
  expect(asked).toEqual([0n, 2n]);
  expect(history.iterations).toEqual([1, 2, 3]);
  expect(states).toEqual(['connecting', 'live', 'reconnecting', 'live', 'ended']);
});

test('JobWatch.Stream that closes early counts as broken', async () => {
  const { asked } = await follow([[running, progress(1n)], [succeeded]]);
  expect(asked).toEqual([0n, 1n]);
});

test('JobWatch.Each attempt in vain waits longer up to a bound', async () => {
  const { waits } = await follow([[cut], [cut], [cut], [cut], [cut], [cut], [cut], [succeeded]]);
  expect(waits).toEqual([125, 250, 500, 1000, 2000, 2500, 2500]);
});

test('JobWatch.Server that says when to come back is heeded', async () => {
  const busy = new ConnectError('full', Code.ResourceExhausted, undefined, [
    { desc: ErrorInfoSchema, value: { reason: 'QUOTA_EXCEEDED', domain: 'ccst.v1' } },
    { desc: RetryAdviceSchema, value: { retryDelay: { seconds: 9n, nanos: 0 } } },
  ]);
  const { waits } = await follow([[busy], [succeeded]]);
  expect(waits).toEqual([9000]);
});

test('JobWatch.Error that waiting does not mend ends the watch', async () => {
  const gone = new ConnectError('no such job', Code.NotFound);
  const { asked, states } = await follow([[gone], [succeeded]]);
  expect(asked).toEqual([0n]);
  expect(states).toEqual(['connecting', 'failed']);
});
