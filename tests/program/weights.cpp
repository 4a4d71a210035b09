// motionlang info and convert on files of weights in other formats than ours.
#include <doctest/doctest.h>

#include <motionlang/file/safetensors.hpp>

#include "../support/temporary_folder.hpp"
#include "../support/tests_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;

namespace {

const std::filesystem::path tests = tests_folder();

std::string sample(const std::string& name) { return (tests / "fuzz/corpus/weights" / name).string(); }
std::string golden(const std::string& name) { return (tests / "golden/cases/containers" / name).string(); }

void check_contains(const std::string& text, std::initializer_list<const char*> parts) {
  for (const std::string part : parts) CHECK_MESSAGE(text.find(part) != std::string::npos, part << " in\n" << text);
}

}  // namespace

TEST_CASE("info: tensors, values and skipped classes of files in every format") {
  const TemporaryFolder folder;
  const auto info = [&](const std::string& file) {
    const Outcome o = run({"info", file}, folder.path);
    CHECK_MESSAGE(o.code == 0, o.text);
    return o.text;
  };
  check_contains(info(sample("checkpoint.ckpt")),
                 {"2 tensors, 7 numbers, 0.0 MB, torch zip", "settings/rate            0.5",
                  "epoch                    3", "skipped: nobody.Config at 'config'", "F32   (2, 3)"});
  check_contains(info(sample("spec_legacy.pt")), {"torch legacy", "F16   (2)"});
  check_contains(info(sample("script.pt")), {"TorchScript", "layers.0.weight"});
  check_contains(info(sample("spec_joblib.pkl")), {"joblib", "0/poses", "0/g                      male"});
  check_contains(info(sample("many_axes.pt")), {"F32   (1, 2, 1, 1, 3, 1, 1, 1, 1)"});
  check_contains(info(golden("tmr_run")), {"TMR run folder", "stats.mean"});
  check_contains(info(golden("repetitive.npz")), {"npz", "ramp", "I64   (3000)"});
  check_contains(info(golden("array_fortran.npy")), {"F64"});
  const Outcome refused = run({"info", golden("malformed/pt_os_system.pt.bad")}, folder.path);
  CHECK(refused.code == 1);
  check_contains(refused.text, {"names posix.system: the file tries to execute code at byte 169 (GLOBAL)"});
  for (const char* name : {"page.ckpt", "page.pth.tar", "page.bin"}) {  // what a download gives where one has to log in
    ml::write_file(folder / name, std::string_view("<!DOCTYPE html><html></html>"));
    const Outcome page = run({"info", name}, folder.path);
    CHECK(page.code == 1);
    check_contains(page.text, {"[motionlang.io.404]", "not a file of weights"});
  }
  ml::write_file(folder / "bytes.dat", std::string_view("some\0bytes", 10));  // no timeline has a zero
  check_contains(run({"info", "bytes.dat"}, folder.path).text, {"[motionlang.io.404]", "not a file of weights"});
}

TEST_CASE("convert: weights of any format become safetensors") {
  const TemporaryFolder folder;
  const auto converted = [&](const std::string& from, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"convert", from, "out.safetensors"});
    const Outcome o = run(more, folder.path);
    CHECK_MESSAGE(o.code == 0, o.text);
    return ml::SafetensorsFile::open(folder / "out.safetensors");
  };
  const auto checkpoint = converted(golden("lightning.ckpt"));
  const auto want = ml::SafetensorsFile::open(golden("lightning.safetensors"));
  CHECK(checkpoint.tensors().size() == 8);
  for (const ml::TensorView& t : checkpoint.tensors()) {
    const ml::TensorView& w = want.tensor("out/" + t.name);
    CHECK(std::equal(t.bytes.begin(), t.bytes.end(), w.bytes.begin(), w.bytes.end()));
  }
  CHECK(checkpoint.metadata().at("hyper_parameters/cfg/latent_dim") == "256");
  CHECK(checkpoint.metadata().at("format") == "pt");

  const auto many = converted(sample("many_axes.pt"), {"--store", "F16"});
  CHECK(many.tensor("w").shape == ml::FileShape{1, 2, 1, 1, 3, 1, 1, 1, 1});
  CHECK(ml::values_of<float>(many.tensor("w")) == std::vector<float>{0, 1, 2, 3, 4, 5});

  const auto arrays = converted(golden("amass_deflated.npz"));
  CHECK(arrays.tensor("poses").shape == ml::Shape{4, 156});
  CHECK(arrays.metadata().at("gender") == "male");
  CHECK(converted(sample("checkpoint.ckpt"), {"--tensors", "optimizer_states"}).names() ==
        std::vector<std::string>{"0.state.0.exp_avg"});
  CHECK(run({"convert", sample("stride_bomb.pt"), "no.safetensors"}, folder.path).code == 1);
  CHECK(!std::filesystem::exists(folder / "no.safetensors"));
}
