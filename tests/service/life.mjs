// The whole life of a job through another implementation of gRPC: Node's, with JavaScript's numbers.
//   node life.mjs ADDRESS PROTO_FOLDER MESH.drc NODE_MODULES
import assert from 'node:assert/strict';
import { createHash, randomUUID } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { promisify } from 'node:util';

const [address, protoFolder, meshFile, modules] = process.argv.slice(2);
const require = createRequire(modules + '/');
const grpc = require('@grpc/grpc-js');
const loader = require('@grpc/proto-loader');

const COUNT = 300;
const ENDED = new Set(['STATE_SUCCEEDED', 'STATE_FAILED', 'STATE_CANCELLED']);

const definition = loader.loadSync(
  ['mesh_service', 'sampling_service', 'server_info_service'].map((n) => `ccst/v1/${n}.proto`),
  // Strings: 64-bit numbers do not fit JavaScript's.
  { includeDirs: [protoFolder], keepCase: true, longs: String, enums: String, defaults: true, oneofs: true },
);
const { ccst } = grpc.loadPackageDefinition(definition);

function connect(Service) {
  const stub = new Service(address, grpc.credentials.createInsecure());
  const call = (method, request) => promisify(stub[method]).call(stub, request);
  const read = async (method, request) => {
    const messages = [];
    for await (const message of stub[method](request)) messages.push(message);
    return messages;
  };
  return { stub, call, read };
}

function upload(stub, data, digest) {
  return new Promise((resolve, reject) => {
    const stream = stub.UploadMesh((error, answer) => (error ? reject(error) : resolve(answer)));
    stream.write({ header: { digest, format: 'MESH_FORMAT_DRACO' } });
    const step = 1000;
    for (let begin = 0; begin < data.length; begin += step) {
      stream.write({ chunk: { offset_bytes: begin, data: data.subarray(begin, begin + step) } });
    }
    stream.end();
  });
}

const info = connect(ccst.v1.ServerInfoService);
const meshes = connect(ccst.v1.MeshService);
const jobs = connect(ccst.v1.SamplingService);

const { limits } = await info.call('GetServerInfo', {});
assert.ok(Number(limits.max_sample_count) >= COUNT);

const data = readFileSync(meshFile);
const digest = { sha256: createHash('sha256').update(data).digest('hex'), size_bytes: data.length };
const { mesh } = await upload(meshes.stub, data, digest);
assert.equal(mesh.name, `meshes/${digest.sha256}`);

// The largest seed: more than a double holds exactly.
const options = { sample_count: COUNT, seed: '18446744073709551615' };
const request = { spec: { mesh: mesh.name, options }, request_id: randomUUID() };
const { job } = await jobs.call('CreateJob', request);
assert.equal((await jobs.call('CreateJob', request)).job.name, job.name);

const events = await jobs.read('WatchJob', { name: job.name });
const end = events.at(-1).snapshot;
assert.ok(ENDED.has(end.state));
assert.equal(end.state, 'STATE_SUCCEEDED');
assert.equal(end.effective_options.seed, options.seed);
const sequences = events.filter((e) => e.event === 'progress').map((e) => Number(e.sequence));
assert.deepEqual(sequences, sequences.map((_, i) => i + 1));

const chunks = await jobs.read('ReadSamples', { name: job.name });
assert.equal(chunks.flatMap((c) => c.samples.face_indices).length, COUNT);
assert.equal(chunks.flatMap((c) => c.samples.positions).length, 3 * COUNT);
const triangles = await jobs.read('ReadSampleMesh', { name: job.name });
assert.equal(triangles.flatMap((c) => c.sample_mesh.vertex_indices).length, 6 * COUNT);
const figures = await jobs.call('AnalyzeJob', { name: job.name });
assert.ok(figures.relative_radius > 0.6);

const listed = await jobs.call('ListJobs', { mesh: mesh.name });
assert.deepEqual(listed.jobs.map((j) => j.name), [job.name]);
await jobs.call('DeleteJob', { name: job.name });
await meshes.call('DeleteMesh', { name: mesh.name });
await assert.rejects(jobs.call('GetJob', { name: job.name }), { code: grpc.status.NOT_FOUND });
console.log(`${COUNT} samples, ${sequences.length} reports`);
