// A published folder that is packed loads as the same model, and says what it is.
#include <motionlang/weights/actor_checkpoint.hpp>
#include <motionlang/weights/model_summary.hpp>
#include <motionlang/weights/pack_run.hpp>

#include "../support/check_error.hpp"
#include "../support/official_vaes.hpp"
#include "../support/temporary_folder.hpp"

namespace ml = motionlang;
using official::all_numbers;
using official::B;

TEST_CASE("a packed ACTOR loads as the one that it was made of, and its summary has the same sizes") {
  const TemporaryFolder folder;
  const auto config = official::small_actor();
  official::write_actor_run(folder / "run", config);
  const ml::RunFolder run = ml::find_run(folder / "run");
  ml::pack_run<B>(run, folder / "packed", {.license = "none", .provenance = "drawn"});
  const auto before = ml::load_actor<B>(folder / "run"), packed = ml::load_actor<B>(folder / "packed");
  CHECK(all_numbers(packed.actor) == all_numbers(before.actor));
  CHECK(packed.file.labels == before.file.labels);
  CHECK(ml::model_summary(ml::find_run(folder / "packed")) == ml::model_summary(run));
  CHECK_FALSE(ml::model_summary(run).empty());
  const std::string about = ml::describe_folder(folder / "packed");
  CHECK_MESSAGE(about.find("actor") != std::string::npos, about);
  CHECK_MESSAGE(about.find("none") != std::string::npos, about);  // the licence
  CHECK_ERROR(ml::pack_run<B>(run, folder / "packed", {.license = "none", .provenance = "drawn"}),
              "[motionlang.io.401]");

  std::filesystem::create_directories(folder / "empty");
  CHECK(ml::describe_folder(folder / "empty").empty());
  CHECK_ERROR(
      ml::pack_run<B>(ml::find_run(folder / "empty"), folder / "nothing", {.license = "none", .provenance = "d"}),
      "[motionlang.io.404]");
}
