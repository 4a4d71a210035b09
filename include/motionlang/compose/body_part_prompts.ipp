// SPDX-License-Identifier: MIT
// Bodies of body_part_prompts.hpp.
#pragma once

#include <motionlang/compose/body_part_prompts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string body_part_prompt(const std::string& action, BodyPartPrompt form) {
  if (form == BodyPartPrompt::free_form) return "List the body parts involved in this action: " + action;
  const auto question = [](const std::string& of) {
    return "Question: What are the body parts involved in the action: " + of + "?\nAnswer:";
  };
  std::string out =
      "Instructions: choose answers from the list ['left arm', 'right arm', 'left leg', 'right leg', 'torso', 'neck', "
      "'buttocks', 'waist']\n\n";
  if (form == BodyPartPrompt::few_shot) {
    out += question("walk forwards") + " right leg\nleft leg\nbuttocks\n\n";
    out += question("face to the left") + " torso\nneck\n\n";
    out += question("put headphones over ears") + " right arm\nleft arm\nneck\n\n";
    out += question("sit down") + " right leg\nleft leg\nbuttocks\nwaist\n\n";
  }
  return out + question(action);
}

MOTIONLANG_NAMESPACE_END
