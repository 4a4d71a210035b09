// Where three.js and three-vrm have the joints of files.
//
//     node three.mjs <folder of node_modules> <jobs.json> <places.json>
//
// jobs.json is a list of {file, times, character?}: times in seconds, and the VRM character that a .vrma moves; without one
// its own nodes are looked at.
// places.json becomes a list of {joint: [[x, y, z], ...]}: a place in the world for each time. With a character the
// joints are the bones of its humanoid.
import {readFileSync, writeFileSync} from 'node:fs';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [folder, jobs, places] = process.argv.slice(2);
const load = (path) => import(pathToFileURL(resolve(folder, path)));
const THREE = await load('three/build/three.module.js');
const {BVHLoader} = await load('three/examples/jsm/loaders/BVHLoader.js');
const {GLTFLoader} = await load('three/examples/jsm/loaders/GLTFLoader.js');
const {VRMLoaderPlugin, VRMUtils} = await load('@pixiv/three-vrm/lib/three-vrm.module.js');
const {VRMAnimationLoaderPlugin, createVRMAnimationClip} =
  await load('@pixiv/three-vrm-animation/lib/three-vrm-animation.module.js');

globalThis.self ??= globalThis;  // loaders ask it for URL
// pictures are not looked at
THREE.TextureLoader.prototype.load = function(url, done) { done?.(new THREE.Texture()); return new THREE.Texture(); };
THREE.ImageBitmapLoader.prototype.load = function(url, done) { done?.({width: 1, height: 1}); };

async function gltf(file) {
  const loader = new GLTFLoader();
  loader.register((parser) => new VRMLoaderPlugin(parser));
  loader.register((parser) => new VRMAnimationLoaderPlugin(parser));
  const bytes = readFileSync(file);
  return loader.parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
}

/// Plays a clip, and writes down where the joints are.
function follow(root, clip, times, joints, update = () => {}) {
  const mixer = new THREE.AnimationMixer(root);
  const action = mixer.clipAction(clip);
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  const out = Object.fromEntries(joints.map(([name]) => [name, []]));
  for (const time of times) {
    mixer.setTime(time);
    update();
    root.updateMatrixWorld(true);
    for (const [name, joint] of joints) out[name].push(joint.getWorldPosition(new THREE.Vector3()).toArray());
  }
  return out;
}

/// The names of nodes are in userData where three.js needs other ones.
function scene_nodes(scene) {
  const nodes = [];
  scene.traverse((node) => {
    if (node.name !== '') nodes.push([node.userData.name ?? node.name, node]);
  });
  return nodes;
}

function read_bvh(job) {
  const {skeleton, clip} = new BVHLoader().parse(readFileSync(job.file, 'utf8'));
  const root = new THREE.Group();
  root.add(skeleton.bones[0]);
  root.scale.setScalar(0.01);  // the file is in centimetres
  const joints = skeleton.bones.filter((bone) => bone.name !== 'ENDSITE');
  return follow(root, clip, job.times, joints.map((bone) => [bone.userData.name ?? bone.name, bone]));
}

async function read_glb(job) {
  const {scene, animations} = await gltf(job.file);
  return follow(scene, animations.at(-1), job.times, scene_nodes(scene));
}

async function read_vrma(job) {
  if (!job.character) {
    const {scene, animations} = await gltf(job.file);
    return follow(scene, animations[0], job.times, scene_nodes(scene));
  }
  const {vrm} = (await gltf(job.character)).userData;
  VRMUtils.rotateVRM0(vrm);
  const animation = (await gltf(job.file)).userData.vrmAnimations[0];
  const clip = createVRMAnimationClip(animation, vrm);
  const bones = Object.keys(vrm.humanoid.humanBones).map((name) => [name, vrm.humanoid.getRawBoneNode(name)]);
  return follow(vrm.scene, clip, job.times, bones, () => vrm.update(0));
}

const results = [];
for (const job of JSON.parse(readFileSync(jobs, 'utf8'))) {
  const read = job.file.endsWith('.bvh') ? read_bvh : job.file.endsWith('.vrma') ? read_vrma : read_glb;
  results.push(await read(job));
}
writeFileSync(places, JSON.stringify(results));
