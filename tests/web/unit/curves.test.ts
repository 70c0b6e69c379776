import { create, createFileRegistry, type DescMessage } from '@bufbuild/protobuf';
import {
  FieldDescriptorProto_Label as Label,
  FieldDescriptorProto_Type as Type,
  FileDescriptorProtoSchema,
  FileDescriptorSetSchema,
} from '@bufbuild/protobuf/wkt';
import { expect, test } from 'vitest';
import { curvesOf, curveTitle } from '../../../client/web/src/job/curves';

/** A report with a curve, as a later version of the API may have it. */
function laterReport(): DescMessage {
  const list = { type: Type.DOUBLE, label: Label.REPEATED };
  const file = create(FileDescriptorProtoSchema, {
    name: 'later.proto',
    package: 'later',
    syntax: 'proto3',
    messageType: [
      { name: 'Curve', field: [{ name: 'x', number: 1, ...list }, { name: 'y', number: 2, ...list }] },
      {
        name: 'Report',
        field: [
          { name: 'figure', number: 1, type: Type.DOUBLE, label: Label.OPTIONAL },
          { name: 'radial_mean', number: 5, type: Type.MESSAGE, typeName: '.later.Curve', label: Label.OPTIONAL },
          { name: 'anisotropy', number: 6, type: Type.MESSAGE, typeName: '.later.Curve', label: Label.OPTIONAL },
        ],
      },
    ],
  });
  const report = createFileRegistry(create(FileDescriptorSetSchema, { file: [file] })).getMessage('later.Report');
  if (!report) throw new Error('no message');
  return report;
}

test('Curves.Fields that are there are found by their form', () => {
  const schema = laterReport();
  const report = create(schema, { figure: 1, radialMean: { x: [0, 1], y: [2, 3] } });
  expect(curvesOf(schema, report)).toEqual([{ name: 'radial_mean', x: [0, 1], y: [2, 3] }]);
  expect(curveTitle('radial_mean')).toBe('Radial mean');
  expect(curveTitle('valence_share')).toBe('Valence share');
});
