// Runs ONNX models with ONNX Runtime (npm onnxruntime-node, resolved from the current folder), called by peer_onnx.py.
// usage: node peer_onnx.mjs THREADS '[{work, config, file, inputs: [{shape, whole}]}, ...]'      prints work,config,variant,threads,min_ms,median_ms
import { createRequire } from "node:module";
import path from "node:path";

const ort = createRequire(path.join(process.cwd(), "here.js"))("onnxruntime-node");
const threads = Number(process.argv[2]);

function tensor({ shape, whole }) {
  const count = shape.reduce((a, b) => a * b, 1);
  if (whole) return new ort.Tensor("int64", BigInt64Array.from({ length: count }, () => 50n), shape);
  return new ort.Tensor("float32", Float32Array.from({ length: count }, () => Math.random() * 2 - 1), shape);
}

for (const { work, config, file, inputs } of JSON.parse(process.argv[3])) {
  const session = await ort.InferenceSession.create(file, {
    intraOpNumThreads: threads,
    interOpNumThreads: 1,
    executionMode: "sequential",
    graphOptimizationLevel: "all",
    executionProviders: ["cpu"],
  });
  const feed = Object.fromEntries(session.inputNames.map((name, i) => [name, tensor(inputs[i])]));
  await session.run(feed);
  await session.run(feed);
  const times = [];
  const start = performance.now();
  while (times.length < 5 || (performance.now() - start < 3000 && times.length < 300)) {
    const before = performance.now();
    await session.run(feed);
    times.push(performance.now() - before);
  }
  times.sort((a, b) => a - b);
  console.log([work, config, "onnxruntime", threads, times[0].toFixed(4), times[times.length >> 1].toFixed(4)].join(","));
  await session.release();
}
