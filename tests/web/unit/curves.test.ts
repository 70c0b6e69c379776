import { create, createFileRegistry, type DescMessage } from '@bufbuild/protobuf';
import {
  FieldDescriptorProto_Label as Label,
  FieldDescriptorProto_Type as Type,
  FileDescriptorProtoSchema,
  FileDescriptorSetSchema,
} from '@bufbuild/protobuf/wkt';
import { expect, test } from 'vitest';
import { curvesOf, curveWords } from '../../../client/web/src/job/curves';

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
          { name: 'angle_histogram', number: 7, type: Type.MESSAGE, typeName: '.later.Curve', label: Label.OPTIONAL },
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
  expect(curveWords('radial_mean').title).toBe('Radial mean');
  expect(curveWords('valence_share').title).toBe('Valence share');
});

test('Curves.Angles are in degrees', () => {
  const schema = laterReport();
  const report = create(schema, { angleHistogram: { x: [Math.PI / 180, Math.PI / 3], y: [0.25, 0.75] } });
  expect(curvesOf(schema, report)).toEqual([{ name: 'angle_histogram', x: [1, 60], y: [0.25, 0.75] }]);
  expect(curveWords('angle_histogram').axis).toBe('Degrees');
});
