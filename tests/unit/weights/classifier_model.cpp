#include <motionlang/weights/classifier_model.hpp>

#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

TEST_CASE("a classifier of either kind gives a score for each class of each window") {
  const ml::Offsets windows{20, 30};
  for (const char* kind : {"gru", "stgcn"}) {
    INFO(std::string(kind));
    ml::ClassifierConfig config;
    config.kind = kind;
    config.clips.translation = false;
    const ml::Classifier<B> classifier(config, 5, ml::Philox{.seed = 1});
    CHECK(classifier.gru.has_value() == (config.kind == "gru"));
    CHECK(classifier.stgcn.has_value() == (config.kind == "stgcn"));
    const ml::Sequences<B> x(tensors::normal<B, 2>({windows.rows(), config.clips.width()}, 3), windows);
    CHECK(classifier(x, config.clips, ml::Philox{}).logits.shape() == ml::Shape{2, 5});
  }
}

TEST_CASE("settings that a classifier cannot have") {
  ml::ClassifierConfig config;
  config.kind = "svm";
  CHECK_ERROR(ml::Classifier<B>(config, 5, ml::Philox{}), "[motionlang.config.103] kind 'svm' is not gru or stgcn");
  config.kind = "stgcn";
  config.clips.translation = true;
  CHECK_ERROR(ml::Classifier<B>(config, 5, ml::Philox{}), "[motionlang.config.102] ST-GCN reads rotations alone");
}
