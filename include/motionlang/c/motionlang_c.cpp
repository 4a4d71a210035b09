// SPDX-License-Identifier: MIT
// motionlang_c.h in terms of the templates. Header-only inside: one unit makes the whole shared library.
#define MOTIONLANG_C_BUILD
#include <motionlang/c/motionlang_c.h>

#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/retarget.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>
#include <motionlang/stmc.hpp>
#include <motionlang/view/viewer.hpp>

namespace ml = motionlang;

struct motionlang_model {
  ml::Stmc<ml::EigenBackend<float>> stmc;
};
struct motionlang_motion {
  ml::Motion motion;
};

namespace {

std::string& message() { return ml::thread_object<std::string, motionlang_model>(); }

/// The id of what f throws, whose message is kept; 0 if it throws nothing.
template <class F>
int done(const F& f) noexcept {
  try {
    try {
      f();
      return 0;
    } catch (const ml::cancelled& e) {
      message() = e.what();
      return MOTIONLANG_CANCELLED;
    } catch (const ml::error& e) {
      message() = e.what();
      return e.id();
    } catch (const std::exception& e) {
      message() = e.what();
    }
  } catch (...) {  // no memory for the message
  }
  return MOTIONLANG_FAILED;
}

template <class T>
T& given(T* argument, const char* name) {
  if (argument == nullptr) ml::raise<ml::config_error>(101, name, " is NULL");
  return *argument;
}

/// done, for what the caller owns from then on: a T of what f makes, NULL if it fails.
template <class T, class F>
int made(T** result, const char* name, const F& f) noexcept {
  return done([&] {
    T*& out = given(result, name);
    out = nullptr;
    out = new T{f()};
  });
}

bool ends_with(const char* file, std::string_view ending) { return std::string_view(file).ends_with(ending); }

std::array<double, 3> numbers_of(const ml::Vec3<double>& v) { return {v.x, v.y, v.z}; }
std::array<double, 4> numbers_of(const ml::Quaternion<double>& q) { return {q.w, q.x, q.y, q.z}; }
/// The numbers of all values, one after the other. Throws shape_error 205 unless there is room for just so many.
template <class V>
void copy_to(float* out, int64_t room, const std::vector<V>& values) {
  const auto count = static_cast<int64_t>(values.size() * numbers_of(V{}).size());
  if (room != count) ml::raise<ml::shape_error>(205, "room for ", room, " floats, there are ", count);
  if (count > 0) given(out, "memory for the numbers");
  for (const V& v : values) {
    for (const double x : numbers_of(v)) *out++ = static_cast<float>(x);
  }
}

}  // namespace

const char* motionlang_version(void) { return MOTIONLANG_VERSION; }
const char* motionlang_message(void) { return message().c_str(); }
int motionlang_set_threads(int32_t threads) {
  return done([&] { ml::set_thread_count(threads); });
}

int motionlang_load_model(const char* file, motionlang_model** model) {
  return made(model, "model", [&] { return ml::load_stmc<ml::EigenBackend<float>>(&given(file, "file")); });
}
void motionlang_free_model(motionlang_model* model) { delete model; }
double motionlang_model_fps(const motionlang_model* model) { return model == nullptr ? 0 : model->stmc.fps; }

motionlang_options motionlang_default_options(void) {
  motionlang_options o{};
  o.cut_texts = o.smooth = o.fix_feet = 1;
  return o;
}

int motionlang_generate(const motionlang_model* model, const char* timeline, const motionlang_options* options,
                        motionlang_motion** motion) {
  return made(motion, "motion", [&] {
    const auto& stmc = given(model, "model").stmc;
    const motionlang_options o = options == nullptr ? motionlang_default_options() : *options;
    auto texts = ml::parse_timeline(&given(timeline, "timeline"), {.fps = stmc.fps});
    if (o.cut_texts != 0) texts = ml::cut_texts(texts, stmc.fps);
    const auto progress = [&](ml::Index step, ml::Index of) {
      return o.progress == nullptr || o.progress(o.user, step, of) != 0;
    };
    ml::StmcOptions how{.hidden = ml::HiddenTexts::ignore, .progress = progress};
    if (o.steps != 0) how.steps = o.steps;
    if (o.guidance != 0) how.guidance = o.guidance;
    ml::Motion out = ml::stmc_motion(stmc.generate(texts, ml::Philox{.seed = o.seed}, how), stmc.fps);
    if (o.smooth != 0) out = ml::smooth_motion(out);
    if (o.fix_feet != 0) out = ml::fix_feet(out);  // last: feet that stand are to be still
    return out;
  });
}

int motionlang_read_motion(const char* file, motionlang_motion** motion) {
  return made(motion, "motion", [&] {
    const char* name = &given(file, "file");
    if (ends_with(name, ".bvh")) return ml::read_bvh_motion(name);
    if (ends_with(name, ".glb") || ends_with(name, ".gltf")) return ml::read_glb(name);
    ml::raise<ml::config_error>(103, "motionlang_read_motion: ", name, " is not one of .bvh, .glb, .gltf");
  });
}
int motionlang_write_motion(const motionlang_motion* motion, const char* file) {
  return done([&] {
    const ml::Motion& m = given(motion, "motion").motion;
    const char* name = &given(file, "file");
    if (ends_with(name, ".bvh")) {
      ml::write_bvh(name, m);
    } else if (ends_with(name, ".glb")) {
      ml::write_glb(name, m);
    } else if (ends_with(name, ".html")) {
      ml::write_viewer(name, m);
    } else {
      ml::raise<ml::config_error>(103, "motionlang_write_motion: ", name, " is not one of .bvh, .glb, .html");
    }
  });
}
int motionlang_retarget(const motionlang_motion* motion, const motionlang_motion* character,
                        motionlang_motion** result) {
  return made(result, "result", [&] {
    return ml::retarget(given(motion, "motion").motion, given(character, "character").motion.skeleton);
  });
}
void motionlang_free_motion(motionlang_motion* motion) { delete motion; }

int64_t motionlang_frames(const motionlang_motion* motion) { return motion == nullptr ? 0 : motion->motion.frames(); }
int32_t motionlang_joints(const motionlang_motion* motion) {
  return motion == nullptr ? 0 : motion->motion.skeleton.size();
}
double motionlang_fps(const motionlang_motion* motion) { return motion == nullptr ? 0 : motion->motion.fps; }
const char* motionlang_joint_name(const motionlang_motion* motion, int32_t joint) {
  return joint < 0 || joint >= motionlang_joints(motion)
             ? nullptr
             : motion->motion.skeleton.names[static_cast<std::size_t>(joint)].c_str();
}
int32_t motionlang_joint_parent(const motionlang_motion* motion, int32_t joint) {
  return joint < 0 || joint >= motionlang_joints(motion) ? -1 : motion->motion.skeleton.parent(joint);
}

int motionlang_offsets(const motionlang_motion* motion, float* xyz, int64_t room) {
  return done([&] { copy_to(xyz, room, given(motion, "motion").motion.skeleton.offsets); });
}
int motionlang_root(const motionlang_motion* motion, float* xyz, int64_t room) {
  return done([&] { copy_to(xyz, room, given(motion, "motion").motion.root); });
}
int motionlang_rotations(const motionlang_motion* motion, float* wxyz, int64_t room) {
  return done([&] { copy_to(wxyz, room, given(motion, "motion").motion.local); });
}
int motionlang_positions(const motionlang_motion* motion, float* xyz, int64_t room) {
  return done([&] { copy_to(xyz, room, given(motion, "motion").motion.positions()); });
}
