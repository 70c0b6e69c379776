import { readFileSync } from 'node:fs';
import { create, toBinary } from '@bufbuild/protobuf';
import { Code, ConnectError } from '@connectrpc/connect';
import { expect, test } from 'vitest';
import { ErrorInfoSchema, FieldViolationsSchema, StatusSchema } from '@api/error_pb';
import { ADVICE_BY_REASON } from '../../../client/web/src/api/advice';
import { explain, explainStatus } from '../../../client/web/src/api/explain';

test('Advice.Reasons are those of the catalogue', () => {
  const catalogue = readFileSync(`${process.env['CCST_ROOT']}/proto/docs/errors.md`, 'utf8');
  const reasons = [...catalogue.matchAll(/^\| `([A-Z_]+)`/gm)].map((match) => match[1] ?? '');
  expect(reasons.length).toBeGreaterThan(20);
  expect(Object.keys(ADVICE_BY_REASON).sort()).toEqual(reasons.sort());
});

test('Explain.Reason and violations of the server are shown', () => {
  const error = new ConnectError('sample_count is 2', Code.InvalidArgument, undefined, [
    { desc: ErrorInfoSchema, value: { reason: 'OPTION_INVALID', domain: 'ccst.v1' } },
    {
      desc: FieldViolationsSchema,
      value: { fieldViolations: [{ field: 'options.sample_count', description: 'at least 4' }] },
    },
  ]);
  const words = explain(error);
  expect(words.title).toBe('An option is out of its range');
  expect(words.detail).toBe('sample_count is 2');
  expect(words.violations).toEqual([{ field: 'options.sample_count', description: 'at least 4' }]);
  expect(words.transient).toBe(false);
});

test('Explain.Network error is transient', () => {
  const words = explain(new TypeError('Failed to fetch'));
  expect(words.title).toBe('The server cannot be reached');
  expect(words.transient).toBe(true);
});

test('Explain.Fault of the program is not tried again', () => {
  const error = new ConnectError('bad_alloc', Code.Internal, undefined, [
    { desc: ErrorInfoSchema, value: { reason: 'INTERNAL', domain: 'ccst.v1' } },
  ]);
  expect(explain(error).transient).toBe(false);
});

test('Explain.Reason of a failed job is found', () => {
  const value = toBinary(ErrorInfoSchema, create(ErrorInfoSchema, { reason: 'MESH_EMPTY' }));
  const status = create(StatusSchema, {
    code: Code.InvalidArgument,
    message: 'no face has an area',
    details: [{ typeUrl: `type.googleapis.com/${ErrorInfoSchema.typeName}`, value }],
  });
  expect(explainStatus(status).title).toBe(ADVICE_BY_REASON['MESH_EMPTY']?.title);
});
