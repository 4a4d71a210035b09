// The studio's server without a network: answers, limits, and clients that do not see each other.
#include <motionlang/generate/studio_server.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <thread>

#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/view/viewer.hpp>

#include "../../support/page_data.hpp"
#include "../../support/rigs.hpp"
#include "../../support/speed_encoder.hpp"
#include "../../support/temporary_folder.hpp"
#include "fake_models.hpp"

namespace ml = motionlang;
using nlohmann::json;

namespace {

/// Makes a walk as long as the timeline that turns by the seed, in three steps.
struct Walker final : ml::MotionModel {
  std::function<void()> at_step = [] {};
  double fps() const override { return 20; }
  std::string system() const override { return "a walker"; }
  ml::Index steps() const override { return 3; }

 private:
  std::vector<ml::Motion> make(std::span<const ml::Timeline> all, const ml::GenerateOptions& o) const override {
    for (ml::Index i = 1; i <= 3; ++i) at_step(), o.progress(i, 3);
    std::vector<ml::Motion> out;
    for (const ml::Timeline& t : all)
      out.push_back(synthetic::walk({.frames = static_cast<int>(t.end()), .turn = static_cast<double>(o.seed)}));
    return out;
  }
};

const std::string anna(32, 'a'), bert(32, 'b');

/// All lines of an answer.
std::vector<json> lines(ml::StudioServer& server, json question, const std::string& client = anna) {
  question["client"] = client;
  std::string all;
  server.answer(question.dump(), [&](std::string_view line) { return all += line, true; });
  std::vector<json> out;
  for (std::size_t at = 0, end; (end = all.find('\n', at)) != all.npos; at = end + 1)
    out.push_back(json::parse(all.substr(at, end - at)));
  return out;
}
json answer(ml::StudioServer& server, const json& question, const std::string& client = anna) {
  return lines(server, question, client).back();
}
json walk_of(int seed) { return {{"kind", "generate"}, {"timeline", "walk # 0 # 2\n"}, {"seed", seed}}; }

bool is_error(const json& line, const std::string& part) {
  return line.contains("error") && std::string(line["error"]).find(part) != std::string::npos;
}
std::string packed(std::span<const std::byte> bytes) { return ml::detail::to_base64(bytes); }

}  // namespace

TEST_CASE("the page asks its server, and has no program, code and model") {
  const ml::StudioServer server(std::make_shared<Walker>());
  const std::string& page = server.page();
  CHECK(page.find("connect-src 'self'") != page.npos);
  CHECK(page.find("id=\"model\"") == page.npos);
  CHECK_FALSE(data_of(page).contains("program"));
  CHECK(page.size() < 300000);
  CHECK_THROWS_AS(ml::StudioServer(nullptr), ml::config_error);
}

TEST_CASE("a motion is made with its progress, drawn, and saved") {
  ml::StudioServer server(std::make_shared<Walker>());
  CHECK(answer(server, {{"kind", "load"}})["value"] == json{{"fps", 20.0},
                                                            {"system", "a walker"},
                                                            {"steps", 3},
                                                            {"folder", false},
                                                            {"search", false},
                                                            {"timelines", false}});
  const auto all = lines(server, walk_of(1));
  REQUIRE(all.size() == 4);
  CHECK(all[0] == json{{"done", 1}, {"total", 3}});
  const json& value = all[3]["value"];
  const ml::Motion want = synthetic::walk({.frames = 40, .turn = 1});
  CHECK(value["data"] == json::parse(ml::viewer_data(want)));
  CHECK(value["record"].is_null());
  CHECK(value["reuse"].is_null());
  const json saved = answer(server, {{"kind", "save"}, {"motion", value["motion"]}, {"format", ".bvh"}});
  CHECK(ml::detail::from_base64(std::string(saved["value"])) == ml::motion_bytes(".bvh", want));
  CHECK(is_error(answer(server, {{"kind", "save"}, {"motion", value["motion"]}, {"format", ".exe"}}), ".exe"));
  CHECK(is_error(answer(server, {{"kind", "save"}, {"motion", 99}, {"format", ".bvh"}}), "this motion is gone"));
  CHECK(answer(server, {{"kind", "check"}, {"timeline", "walk # 0 # 2\n"}})["value"]["seconds"] == 2);
  CHECK(is_error(answer(server, {{"kind", "check"}, {"timeline", "walk"}}), "timeline:1:"));
  CHECK(answer(server, {{"kind", "known"}, {"begun", "w"}, {"count", 3}})["value"] == json::array());
  CHECK(is_error(answer(server, {{"kind", "files"}}), "no folder"));
}

TEST_CASE("a client has its own motions and files only") {
  ml::StudioServer server(std::make_shared<Walker>(), {.clients = 2, .motions = 2, .files = 1});
  const json mine = answer(server, walk_of(1))["value"]["motion"];
  const json theirs = answer(server, walk_of(2), bert)["value"]["motion"];
  CHECK(mine != theirs);
  const json save_mine{{"kind", "save"}, {"motion", mine}, {"format", ".bvh"}};
  CHECK(answer(server, save_mine).contains("value"));
  CHECK(is_error(answer(server, save_mine, bert), "this motion is gone"));
  for (int i = 0; i < 5; ++i) answer(server, walk_of(i), bert);  // forgets those of its own
  CHECK(answer(server, save_mine).contains("value"));
  CHECK(is_error(answer(server, {{"kind", "save"}, {"motion", theirs}, {"format", ".bvh"}}, bert), "is gone"));
  const std::string carl(32, 'c');  // takes the place of the longest silent
  const json his = answer(server, walk_of(1), carl)["value"]["motion"];
  CHECK(is_error(answer(server, save_mine), "this motion is gone"));
  CHECK(answer(server, {{"kind", "save"}, {"motion", his}, {"format", ".bvh"}}, carl).contains("value"));
}

TEST_CASE("a file is kept in a motion, or refused") {
  ml::StudioServer server(std::make_shared<Walker>());
  const auto bvh = ml::motion_bytes(".bvh", synthetic::walk({.frames = 60}));
  const json read = answer(server, {{"kind", "read"}, {"id", "x"}, {"name", "walk.bvh"}, {"bytes", packed(bvh)}});
  CHECK(read["value"]["seconds"] == doctest::Approx(3).epsilon(0.01));
  json with = walk_of(1);
  with["clip"] = {{"id", "x"}, {"from", 1}, {"start", 0.5}, {"end", 1.5}, {"parts", "legs"}};
  CHECK(is_error(answer(server, with), "keep"));  // the walker keeps nothing, and says so
  with["clip"]["id"] = "y";
  CHECK(is_error(answer(server, with), "the file of the kept motion is gone"));
  CHECK(is_error(answer(server, {{"kind", "read"}, {"name", "x.txt"}, {"bytes", "AAAA"}}), "reads motions"));
  CHECK(is_error(answer(server, {{"kind", "read"}, {"name", "x.bvh"}, {"bytes", "AAAA"}}), "x.bvh"));
  const auto rig = rigs::glb_of(rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:"));
  const json motion = answer(server, walk_of(0))["value"]["motion"];
  const json shown = answer(server, {{"kind", "show"}, {"motion", motion}, {"name", "me.vrm"}, {"bytes", packed(rig)}});
  CHECK(shown["value"]["body"].contains("positions"));
  const json saved = answer(server, {{"kind", "save"},
                                     {"motion", motion},
                                     {"format", ".glb"},
                                     {"character", {{"name", "me.vrm"}, {"bytes", packed(rig)}}}});
  CHECK(ml::detail::from_base64(std::string(saved["value"])).size() > rig.size());
}

TEST_CASE("the project's folder is the only one") {
  const TemporaryFolder place;
  ml::StudioServer server(std::make_shared<Walker>(), {.project = place.path});
  const json motion = answer(server, walk_of(1))["value"]["motion"];
  const auto save = [&](const char* name) {
    return answer(server, {{"kind", "save"}, {"motion", motion}, {"format", ".bvh"}, {"id", name}});
  };
  CHECK(save("walk.bvh")["value"] == true);
  for (const char* name : {"../walk.bvh", "/tmp/walk.bvh", ".bvh", "walk.sh"}) CHECK(save(name).contains("error"));
  const auto store = [&](const char* bytes, json over = nullptr) -> json {
    return answer(server, {{"kind", "store"}, {"name", "t.txt"}, {"bytes", bytes}, {"over", over}})["value"]["mark"];
  };
  const json lost = store("bG9zdA=="), mark = store("aGk=");  // without a condition it overwrites
  CHECK(lost != mark);
  CHECK(answer(server, {{"kind", "files"}})["value"] == json{"t.txt", "walk.bvh"});
  CHECK(answer(server, {{"kind", "open"}, {"name", "t.txt"}})["value"] == json{{"bytes", "aGk="}, {"mark", mark}});
  for (const json& over : {lost, json("")}) CHECK(store("bG9zdA==", over).is_null());  // other contents are there
  CHECK(answer(server, {{"kind", "open"}, {"name", "t.txt"}})["value"]["bytes"] == "aGk=");
  CHECK(store("aGkh", mark) != mark);
  CHECK(answer(server, {{"kind", "open"}, {"name", "t.txt"}})["value"]["bytes"] == "aGkh");
  std::filesystem::remove(place / "t.txt");
  CHECK(store("aGk=", "") == mark);  // nothing is there
  CHECK(is_error(answer(server, {{"kind", "open"}, {"name", "../t.txt"}}), "../t.txt"));
  CHECK_THROWS_AS(ml::StudioServer(std::make_shared<Walker>(), {.project = place / "none"}), ml::io_error);
}

TEST_CASE("words find moments in the project, and a moment becomes a file to keep") {
  const TemporaryFolder place;
  ml::write_motion(place / "slow.bvh", synthetic::walk({.frames = 100, .fps = 20, .steps_per_second = 1}));
  ml::write_motion(place / "fast.bvh", synthetic::walk({.frames = 100, .fps = 20, .steps_per_second = 3}));
  int loaded = 0;
  const auto encoder = [&]() -> std::shared_ptr<const ml::SearchEncoder> {
    ++loaded;
    return std::make_shared<SpeedEncoder>();
  };
  ml::StudioServer server(std::make_shared<Walker>(),
                          {.limits = {.remembered = 4}, .project = place.path, .search_model = encoder});
  CHECK(answer(server, {{"kind", "load"}})["value"]["search"] == true);
  CHECK(loaded == 0);  // not before somebody searches
  const json ask{{"kind", "search"}, {"words", "walk 9"}, {"count", 2}};
  const auto all = lines(server, ask);
  CHECK(all.front() == json{{"done", 2}, {"total", 2}});
  const json found = all.back()["value"];
  CHECK(found["clips"] == 2);
  CHECK(found["skipped"] == 0);
  REQUIRE(found["moments"].size() == 2);
  const json first = found["moments"][0];
  CHECK(first["name"] == "fast.bvh");
  const json moment = answer(server, {{"kind", "moment"}, {"motion", first["number"]}})["value"];
  const double start = first["start"], end = first["end"];
  CHECK(double(moment["from"]) == doctest::Approx(std::min(2.0, start)).epsilon(0.02));
  CHECK(double(moment["seconds"]) == doctest::Approx(end - start).epsilon(0.05));
  const json read = answer(server, {{"kind", "read"}, {"id", "x"}, {"name", "x.glb"}, {"bytes", moment["bytes"]}});
  CHECK(double(read["value"]["seconds"]) >= double(moment["from"]) + double(moment["seconds"]) - 0.06);
  CHECK(is_error(answer(server, {{"kind", "moment"}, {"motion", first["number"]}}, bert), "this moment is gone"));
  for (int i = 0; i < 2; ++i) CHECK(lines(server, ask).size() == 1);  // nothing is read again
  CHECK(is_error(answer(server, {{"kind", "moment"}, {"motion", first["number"]}}), "this moment is gone"));
  CHECK(loaded == 1);
  CHECK(std::filesystem::exists(place / ".motionlang.index"));
  CHECK(answer(server, {{"kind", "files"}})["value"] == json{"fast.bvh", "slow.bvh"});
  CHECK(is_error(answer(server, {{"kind", "open"}, {"name", ".motionlang.index"}}), ".motionlang.index"));
  CHECK(is_error(answer(server, {{"kind", "search"}}), "no words"));
  ml::StudioServer without(std::make_shared<Walker>(), {.project = place.path});
  CHECK(is_error(answer(without, ask), "searches no folder"));
}

TEST_CASE("limits of length, time and number") {
  ml::StudioServer server(std::make_shared<Walker>(), {.limits = {.seconds = 3}, .generation_seconds = 0});
  CHECK(is_error(answer(server, {{"kind", "generate"}, {"timeline", "walk # 0 # 4\n"}}), "at most 3"));
  CHECK(is_error(answer(server, walk_of(1)), "cancel"));
  CHECK(is_error(lines(server, {{"kind", "run"}}).back(), "run"));
  ml::StudioServer brief(std::make_shared<Walker>(), {.limits = {.read_seconds = 2}});
  for (const int frames : {40, 60}) {
    const auto bvh = packed(ml::motion_bytes(".bvh", synthetic::walk({.frames = frames})));
    const json read = answer(brief, {{"kind", "read"}, {"id", "x"}, {"name", "walk.bvh"}, {"bytes", bvh}});
    CHECK_MESSAGE((frames == 40 ? read.contains("value") : is_error(read, "reads at most 2")), read.dump());
  }
}

TEST_CASE("a waiting line for who waits; who leaves stops the work, and too many are refused") {
  const auto model = std::make_shared<Walker>();
  std::atomic<bool> inside = false, go_on = false;
  model->at_step = [&] {
    inside = true;
    while (!go_on) std::this_thread::yield();
  };
  ml::StudioServer server(model, {.together = 1, .waiting = 1});
  std::thread first([&] { CHECK(answer(server, walk_of(1)).contains("value")); });
  while (!inside) std::this_thread::yield();
  std::atomic<bool> waits = false;
  std::thread second([&] {
    std::string last;
    json question = walk_of(2);
    question["client"] = bert;
    server.answer(question.dump(), [&](std::string_view line) {
      last = line;
      if (line.find("waiting") != line.npos) waits = true;
      return true;
    });
    CHECK(last.find("\"value\"") != last.npos);
  });
  while (!waits) std::this_thread::yield();
  CHECK(is_error(answer(server, walk_of(3)), "too many"));
  const json file{{"kind", "read"}, {"id", "x"}, {"name", "x.bvh"}, {"bytes", "AAAA"}};
  for (const json& question : {file, json{{"kind", "show"}, {"motion", 1}}, json{{"kind", "save"}, {"motion", 1}}})
    CHECK(is_error(answer(server, question), "too many"));
  CHECK(answer(server, {{"kind", "load"}}).contains("value"));  // other questions do not wait
  go_on = true;
  first.join();
  second.join();
  int steps = 0;
  json question = walk_of(1);
  question["client"] = anna;
  server.answer(question.dump(), [&](std::string_view line) {
    if (line.find("\"done\"") != line.npos) ++steps;
    return false;
  });
  CHECK(steps == 1);
  CHECK(answer(server, walk_of(1)).contains("value"));  // the turn is free again
}
