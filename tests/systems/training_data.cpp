// The training data of the bundled model: captions change with the clip (mirrored, cut), and the loss on feet.
#include <doctest/doctest.h>

#include <map>
#include <numbers>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/datasets/clip_lines.hpp>
#include <motionlang/datasets/training_set.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/kinematics/foot_contact.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/loss/foot_velocity.hpp>

#include "../support/check_error.hpp"
#include "../support/temporary_folder.hpp"
#include "../support/training_set.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<double>;
using A = ml::Autodiff<B>;

namespace {

const ml::TrainingSet& data() { return captioned::training_set(); }

ml::SampleOptions plain() {
  return {.shortest = 30,
          .longest = 40,
          .no_text = 0,
          .compose = 0,
          .mirror = 0,
          .speed = 0,
          .tempo = 0,
          .reverse = 0,
          .curve = 0,
          .then = 0};
}

double way_ahead(const ml::TrainingSample& s) {  // metres
  double sum = 0;
  for (ml::Index f = 0; f < s.frames; ++f)
    sum += static_cast<double>(s.features[static_cast<std::size_t>(f * ml::smplrifke_size) + 2]);
  return sum;
}

/// The mean of `value` over the samples whose caption is `caption`.
template <class F>
double mean_of(const ml::SampleOptions& options, const std::string& caption, F value) {
  double sum = 0, count = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const auto s = data().draw(ml::Philox{.seed = seed}, options);
    if (s.caption == caption) sum += value(s) / static_cast<double>(s.frames), ++count;
  }
  REQUIRE(count > 5);
  return sum / count;
}

}  // namespace

TEST_CASE("tables of clips: a name with its extension, a name without where one file has it, an error where two have") {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  for (const char* file : {"a.bvh", "a.npz", "b.bvh", "b.txt", "sub/c.npz.bvh", "Mean.bvh"}) {
    fs::create_directories((folder / file).parent_path());
    ml::write_file(folder / file, std::string_view("x"));
  }
  ml::write_npy(folder / "Mean.npy", ml::NpyArray::of(std::span<const float>(std::vector<float>{1, 2}), {2}));
  const auto read = [&](const std::string& clip) {
    ml::write_file(folder / "t.tsv", clip + "\t0\t1\tlegs\twalk\n");
    const auto line = ml::read_captions(folder / "t.tsv", folder.path).front();
    ml::write_file(folder / "t.tsv", clip + "\t0\t1\twalk\n");
    const auto label = ml::read_labels(folder / "t.tsv", folder.path).front();
    CHECK((line.clip == label.clip && line.file == label.file && line.id == label.id && line.id == line.clip));
    return std::pair(line.clip, line.file.empty() ? "" : line.file.lexically_relative(folder.path).generic_string());
  };
  using Found = std::pair<std::string, std::string>;
  CHECK(read("a.bvh") == Found("a.bvh", "a.bvh"));
  CHECK(read("a.npz") == Found("a.npz", "a.npz"));
  CHECK(read("b") == Found("b", "b.bvh"));
  CHECK(read("b.bvh") == Found("b", "b.bvh"));
  CHECK(read("sub/c.npz") == Found("sub/c.npz", "sub/c.npz.bvh"));  // that is its name without extension
  CHECK(read("b.npz") == Found("b.npz", ""));
  CHECK(read("Mean") == Found("Mean", "Mean.bvh"));  // an array of one axis is not a motion
  for (const char* table : {"\t0\t1\tlegs\twalk\n", "\twalk\n"}) {
    ml::write_file(folder / "t.tsv", "b" + std::string(table) + "a" + table);
    const std::string refusal = "[motionlang.io.403] " + (folder / "t.tsv").string() + ":2: 'a' may be " +
                                (folder / "a.bvh").string() + " or " + (folder / "a.npz").string() +
                                ": add its extension";
    CHECK_ERROR(ml::read_captions(folder / "t.tsv", folder.path), refusal.c_str());
  }
  // a data set, whose features have names of their own, and AMASS by the names of its folders
  fs::create_directories(folder / "new_joint_vecs");
  ml::write_file(folder / "new_joint_vecs/d.npy", std::string_view("x"));
  fs::create_directories(folder / "MoSh/1");
  ml::write_file(folder / "MoSh/1/e.npz", std::string_view("x"));
  CHECK(read("d") == Found("d", "new_joint_vecs/d.npy"));
  CHECK(read("MPI_mosh/1/e") == Found("MPI_mosh/1/e", "MoSh/1/e.npz"));
  ml::write_file(folder / "d.bvh", std::string_view("x"));
  CHECK_ERROR(read("d"), "'d' may be ");
}

TEST_CASE("a caption of walking played backwards says so, and one that says more has none") {
  CHECK(ml::reversed_caption("a person walks forward") == "a person walks backwards");
  CHECK(ml::reversed_caption("walk straight ahead slowly") == "walk straight backwards slowly");
  for (const char* caption : {"walk", "walk forward and turn left", "step forward and kick", "jump forward", "",
                              "walk forward up the stairs", "lean forward"})
    CHECK_MESSAGE(!ml::reversed_caption(caption), caption);
  CHECK(ml::mirrored_caption("raise the left arm, turn right") == "raise the right arm, turn left");
}

TEST_CASE("a caption of walking along a curve says which, by the angle and the side") {
  CHECK(ml::curved_caption("a person walks forward", 5, 0) == "a person walks in a circle to the left");
  CHECK(ml::curved_caption("a person walks forward", -5, 0) == "a person walks in a circle");
  for (std::uint32_t wording = 0; wording < 20; ++wording)
    CHECK(ml::curved_caption("walk forward", 5, wording) != "walk in a circle");  // no side means to the right
  CHECK(ml::curved_caption("walk straight ahead slowly", -5, 3) == "walk in a clockwise circle slowly");
  CHECK(ml::curved_caption("run forward", -1.5, 3) == "run in a quarter circle to the right");
  CHECK(ml::curved_caption("run forward", 3, 0) == "run in a half circle to the left");
  CHECK(ml::curved_caption("run forward", 1, 2) == "run to the left");
  CHECK(!ml::curved_caption("run forward", 0.3, 0));  // hardly a curve
  for (const char* caption : {"walk", "walk forward and turn left", "jump forward", ""})
    CHECK_MESSAGE(!ml::curved_caption(caption, 5, 0), caption);
}

TEST_CASE("walking is played backwards, slower and faster, and the captions follow") {
  const double ahead = mean_of(plain(), "a person walks forward", way_ahead);
  CHECK(std::abs(ahead) > 0.02);  // metres per frame
  auto options = plain();
  options.reverse = 1;
  CHECK(mean_of(options, "a person walks backwards", way_ahead) == doctest::Approx(-ahead).epsilon(0.15));
  options = plain();
  options.tempo = 1;
  CHECK(mean_of(options, "a person walks forward slowly", way_ahead) == doctest::Approx(0.6 * ahead).epsilon(0.15));
  CHECK(mean_of(options, "a person walks forward quickly", way_ahead) == doctest::Approx(1.6 * ahead).epsilon(0.15));
}

TEST_CASE(
    "an action that is not a cycle is drawn whole, though it ends as it begins, and takes longer where there is time "
    "for "
    "it") {
  const TemporaryFolder folder;
  auto bow = synthetic::walk({.frames = 30});
  for (ml::Index f = 0; f < 30; ++f) {
    bow.root[static_cast<std::size_t>(f)] = bow.root_at(0);
    std::ranges::copy(bow.rotations(0), bow.rotations(f).begin());
    bow.rotations(f)[3] = synthetic::about_x(1.2 * std::sin(std::numbers::pi * static_cast<double>(f) / 29));
  }
  ml::write_bvh(folder / "bow.bvh", bow);
  ml::write_file(folder / "captions.tsv", std::string_view("bow\t0\t1.5\tspine\ta person bows\n"));
  const ml::TrainingSet set(folder / "captions.tsv", folder.path, {});
  CHECK(!set.segments().front().loop);
  auto options = plain();
  for (ml::Index wanted : {30, 60, 150}) {
    options.shortest = options.longest = wanted;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const auto s = set.draw(ml::Philox{.seed = seed}, options);
      const double longer = wanted == 30 ? 1 : 2;  // at most twice as long
      CHECK(static_cast<double>(s.frames) > (0.9 * 30 - 2) * longer);
      CHECK(static_cast<double>(s.frames) <= 30 * longer);
      auto head = [&](ml::Index f) {
        return s.features[static_cast<std::size_t>(f * ml::smplrifke_size + 133 + 3 * 15 + 2)];
      };
      CHECK(head(0) - head(s.frames / 2) > 0.15);
      CHECK(head(s.frames - 1) - head(s.frames / 2) > 0.15);
    }
  }
  CHECK(data().segments().front().loop);  // walking is a cycle
}

TEST_CASE("an animation of a file is a clip, a cycle goes on, and an action is followed by what the table says") {
  const TemporaryFolder folder;
  auto walk = synthetic::walk({.frames = 21, .steps_per_second = 2});  // one cycle
  for (auto& root : walk.root) root.x = root.z = 0;
  auto lift = synthetic::walk({.frames = 20});
  for (ml::Index f = 0; f < 20; ++f) {
    lift.root[static_cast<std::size_t>(f)] = lift.root_at(0);
    std::ranges::copy(lift.rotations(0), lift.rotations(f).begin());
    lift.rotations(f)[16] = synthetic::about_z(-1.3 + 0.1 * static_cast<double>(f));
  }
  auto idle = ml::crop(lift, 0, 1);
  for (int k = 0; k < 29; ++k) idle = ml::concatenate(idle, ml::crop(lift, 0, 1));
  walk.name = "Walk Loop", lift.name = "Lift", idle.name = "Idle";
  ml::write_glb(folder / "hero.glb", std::vector<ml::Motion>{walk, lift, idle});
  const auto set = [&](const std::string& table) {
    ml::write_file(folder / "captions.tsv", table);
    return ml::TrainingSet(folder / "captions.tsv", folder.path, {});
  };
  const auto arm = [](const ml::TrainingSample& s, ml::Index f) {  // height of the left wrist
    return s.features[static_cast<std::size_t>(f * ml::smplrifke_size + 133 + 3 * 20 + 2)];
  };
  auto options = plain();
  options.shortest = options.longest = 100;

  const auto cycle = set("hero.glb#Walk Loop\t0\t9\tlegs\twalk\trepeat\n");
  CHECK(cycle.segments().front().clip == "hero.glb#Walk Loop");
  CHECK(cycle.segments().front().motion.frames() == 21);
  const auto walked = cycle.draw(ml::Philox{.seed = 1}, options);
  CHECK(walked.frames > 85);
  CHECK(std::abs(way_ahead(walked)) > 1);

  const auto held = set("hero.glb#Lift\t0\t9\tleft arm\traise the left arm\thold\n");
  CHECK(held.seconds() == doctest::Approx(1));
  const auto lifted = held.draw(ml::Philox{.seed = 1}, options);
  CHECK(lifted.frames == 60);  // three times as long as the action
  CHECK(arm(lifted, 19) - arm(lifted, 0) > 0.4);
  CHECK(arm(lifted, 59) == doctest::Approx(arm(lifted, 22)).epsilon(0.02));

  const auto followed = set("hero.glb#Lift\t0\t9\tleft arm\traise the left arm\tthen hero.glb#Idle\n");
  CHECK(followed.seconds() == doctest::Approx(1));
  const auto back = followed.draw(ml::Philox{.seed = 1}, options);
  CHECK(back.frames == 60);
  CHECK(arm(back, 12) - arm(back, 0) > 0.2);
  CHECK(arm(back, 59) == doctest::Approx(arm(back, 0)).epsilon(0.05));
  options.shortest = 10, options.longest = 25;  // the action is never cut
  for (std::uint64_t seed = 0; seed < 10; ++seed) CHECK(followed.draw(ml::Philox{.seed = seed}, options).frames >= 20);

  const auto refused = [&](const char* column, const char* message) {
    CHECK_ERROR(set(std::string("hero.glb#Lift\t0\t9\tlegs\tlift\t") + column + "\n"), message);
  };
  refused("repeat", ":1: 'hero.glb#Lift' is to repeat, but its 20 frames end ");
  refused("jump", ":1: 'jump' is not 'repeat', 'hold', 'seated' or one 'then CLIP'");
  refused("hold,repeat", ":1: 'repeat', 'hold' and 'then CLIP' exclude each other");
  refused("then hero.glb#Lift", "is to repeat, but its 20 frames end ");
  CHECK_ERROR(set("hero.glb#Run\t0\t9\tlegs\trun\n"), "[motionlang.config.103]");
  CHECK_ERROR(set("hero.glb\t0\t9\tlegs\trun\n"), "[motionlang.config.102]");
  CHECK_ERROR(set("nobody.glb#Run\t0\t9\tlegs\trun\n"), "there is no ");
}

TEST_CASE("what few segments show is drawn more often, and arms are laid over people who stand still") {
  const TemporaryFolder folder;
  ml::write_bvh(folder / "walk.bvh", synthetic::walk({.frames = 60}));
  auto stand = synthetic::walk({.frames = 60});
  for (ml::Index f = 0; f < 60; ++f) {
    stand.root[static_cast<std::size_t>(f)] = stand.root_at(0);
    std::ranges::copy(stand.rotations(0), stand.rotations(f).begin());
  }
  ml::write_bvh(folder / "stand.bvh", stand);
  std::string table = "stand\t0\t3\tleft arm,right arm,legs\tstand still | stand with hanging arms\n";
  for (int k = 0; k < 30; ++k) table += "walk\t0\t3\tlegs\twalk along | walk ahead\n";
  table += "walk\t0\t3\tleft arm\tswing the left arm\n";
  ml::write_file(folder / "captions.tsv", table);
  const ml::TrainingSet set(folder / "captions.tsv", folder.path, {});
  const auto& segments = set.segments();
  CHECK(segments[0].weight == 4);  // of at most 4
  CHECK(segments[1].weight == doctest::Approx(std::sqrt(100 / 30.0)));
  auto options = plain();
  const auto count = [&](const char* word) {
    int found = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed)
      found += static_cast<int>(set.draw(ml::Philox{.seed = seed}, options).caption.starts_with(word));
    return found;
  };
  const double share = 4 / (8 + 30 * std::sqrt(100 / 30.0));  // 0.064; 0.031 if all were alike
  CHECK(count("stand") > 400 * share * 0.6);
  CHECK(count("stand") < 400 * share * 1.5);
  // Practised words are drawn more often.
  ml::TrainingSet practised = set;
  practised.practise(std::vector<std::string>{"stand", "Stand still"}, 8);
  CHECK(practised.segments()[0].weight == 32);
  CHECK(practised.segments()[1].weight == segments[1].weight);
  int stands_now = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed)
    stands_now += static_cast<int>(practised.draw(ml::Philox{.seed = seed}, options).caption.starts_with("stand"));
  CHECK(stands_now > 400 * 8 * share / (1 + 7 * share) * 0.7);
  CHECK(stands_now > 3 * count("stand"));
  CHECK_ERROR(practised.practise(std::vector<std::string>{"walk", "fly"}, 2),
              "[motionlang.config.102] TrainingSet: no caption has \"fly\", so none can be chosen by it");
  CHECK(practised.segments()[1].weight == segments[1].weight);  // nothing was changed
  CHECK_ERROR(practised.practise(std::vector<std::string>{"walk"}, 0),
              "[motionlang.config.101] TrainingSet: words are practised 0 times as often");
  options.compose = options.still = 1;
  int together = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const auto s = set.draw(ml::Philox{.seed = seed}, options);
    CHECK(std::abs(way_ahead(s)) < 0.1);
    CHECK(s.caption.find("hanging") == s.caption.npos);
    together += static_cast<int>(s.caption == "stand still while swing the left arm");
  }
  CHECK(together > 10);
  // A sample says what its caption commands, and nothing for two actions or no words.
  CHECK(set.verbs() == std::vector<std::string>{"stand", "walk", "swing"});
  CHECK(segments[0].verb == 0);
  CHECK(segments[1].verb == 1);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const auto s = set.draw(ml::Philox{.seed = seed}, options);
    const bool swing = s.caption == "swing the left arm", stands = s.caption == "stand still";
    CHECK_MESSAGE(s.verb == (swing ? 2 : stands ? 0 : -1), s.caption);
  }
  // The arm swings for a while, and the caption does not say so.
  options.passing = 1;
  const auto moved = [](const ml::TrainingSample& s, ml::Index frame) {  // the left shoulder since the first frame
    const auto* turns = s.features.data() + 4 + 16 * 6;
    double most = 0;
    for (ml::Index k = 0; k < 6; ++k)
      most = std::max(most, std::abs(double(turns[frame * ml::smplrifke_size + k]) - double(turns[k])));
    return most > 0.02;
  };
  int there_and_back = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const auto s = set.draw(ml::Philox{.seed = seed}, options);
    CHECK(s.caption == "stand still");
    CHECK(s.verb == 0);
    bool swings = false;
    for (ml::Index f = 1; f < s.frames; ++f) swings = swings || moved(s, f);
    there_and_back += static_cast<int>(swings && !moved(s, 1) && !moved(s, s.frames - 1));
  }
  CHECK(there_and_back > 20);
  options.passing = 0;
  options.no_text = 1;
  CHECK(set.draw(ml::Philox{.seed = 1}, options).verb == -1);
  options.no_text = options.still = 0;
  CHECK(std::abs(way_ahead(set.draw(ml::Philox{.seed = 1}, options))) > 0.5);
}

TEST_CASE("a text that names no side is shown to the right") {
  const TemporaryFolder folder;
  ml::write_bvh(folder / "turn.bvh", synthetic::walk({.frames = 60, .turn = 0.8}));
  ml::write_file(folder / "captions.tsv", "turn\t0\t3\tlegs\tturn | turn to the left\n");
  const ml::TrainingSet set(folder / "captions.tsv", folder.path, {});
  CHECK(set.segments()[0].side == ml::Side::left);
  auto options = plain();
  options.mirror = 0.5;
  std::map<std::string, int> seen;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const auto s = set.draw(ml::Philox{.seed = seed}, options);
    double turned = 0;  // to the left
    for (ml::Index f = 0; f < s.frames; ++f)
      turned += static_cast<double>(s.features[static_cast<std::size_t>(f * ml::smplrifke_size) + 3]);
    CHECK_MESSAGE((turned > 0.5) == (s.caption == "turn to the left"), s.caption, ": ", turned);
    CHECK_MESSAGE((turned < -0.5) == (s.caption != "turn to the left"), s.caption, ": ", turned);
    ++seen[s.caption];
  }
  CHECK(seen["turn"] > 15);
  CHECK(seen["turn to the left"] > 5);
  CHECK(seen["turn to the right"] > 5);
  CHECK(seen.size() == 3);
  options.then = 1;  // also in two actions after each other
  int both = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const auto s = set.draw(ml::Philox{.seed = seed}, options);
    if (s.caption.find("turn ") != 0 || s.caption.find("left") != s.caption.npos ||
        s.caption.find("to the right") != s.caption.npos || s.caption.find("turn", 1) == s.caption.npos)
      continue;  // "turn and then turn" and the like
    for (ml::Index f = 0; f + 1 < s.frames; ++f)
      CHECK(s.features[static_cast<std::size_t>(f * ml::smplrifke_size) + 3] < 0.02);
    ++both;
  }
  CHECK(both > 3);
}

TEST_CASE("the loss on feet: nothing for the truth, the speed squared for a path that slides") {
  const auto sample = data().draw(ml::Philox{.seed = 3}, plain());
  const ml::Shape shape{sample.frames, ml::smplrifke_size};
  const std::vector<double> truth(sample.features.begin(), sample.features.end());
  const auto x0 = ml::Tensor<B, 2>::from(truth, shape);
  const ml::Offsets one(std::vector<ml::Index>{sample.frames});

  const auto feet = ml::detail::feet_of(x0);  // by the rotations: the same as the joints in the features
  for (ml::Index f = 0; f < sample.frames; ++f) {
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        const auto joint = static_cast<std::size_t>(ml::smpl_contact_joints[k].joint);
        CHECK(feet.span()[static_cast<std::size_t>(f) * 12 + 3 * k + c] ==
              doctest::Approx(truth[static_cast<std::size_t>(f * 205) + 133 + 3 * joint + c]).epsilon(1e-4));
      }
    }
  }
  auto loss = [&](const std::vector<double>& values) {
    return ml::foot_velocity_loss<A>(ml::Tensor<A, 2>::from(values, shape), x0, one, 20).item();
  };
  CHECK(loss(truth) < 1e-20);
  auto sliding = truth;
  for (ml::Index f = 0; f < sample.frames; ++f) sliding[static_cast<std::size_t>(f * 205) + 1] += 0.05;  // 1 m/s
  CHECK(loss(sliding) > 1.0 / 3);  // one of three coordinates, standing feet count five times
  CHECK(loss(sliding) < 5.0 / 3);
  auto rising = truth;
  for (ml::Index f = 0; f < sample.frames; ++f)
    rising[static_cast<std::size_t>(f * 205)] += 0.05 * static_cast<double>(f);
  CHECK(loss(rising) == doctest::Approx(loss(sliding)));
}
