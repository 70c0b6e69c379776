import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';
import { IterationProgressSchema } from '@api/job_pb';
import { RunHistory } from '../../../client/web/src/job/run_history';

const report = (iteration: number) =>
  create(IterationProgressSchema, { iteration, capacityCv: 1 / iteration, flipCount: 7n });

test('RunHistory.Report of a new sequence is appended', () => {
  const history = new RunHistory();
  expect(history.add(1n, report(1))).toBe(true);
  expect(history.add(2n, report(2))).toBe(true);
  expect(history.iterations).toEqual([1, 2]);
  expect(history.capacityCvs).toEqual([1, 0.5]);
  expect(history.flips).toEqual([7, 7]);
  expect(history.lastSequence).toBe(2n);
});

test('RunHistory.Replayed report is not taken twice', () => {
  const history = new RunHistory();
  history.add(1n, report(1));
  history.add(2n, report(2));
  expect(history.add(1n, report(1))).toBe(false);
  expect(history.add(2n, report(2))).toBe(false);
  expect(history.length).toBe(2);
});
