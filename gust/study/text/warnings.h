#pragma once

#include <span>
#include <string>
#include <vector>

#include "gust/study/text/study.h"

namespace gust {

/// The values of a parameter with which the plant can be held at its goal, given how far the readings let a command go.
Limits possible_values(const Setup& setup, std::size_t parameter);

/// One sentence for each disturbance whose wave has so few samples a period that its shape is coarse; `whose` it is
/// comes first where it is not empty.
std::vector<std::string> wave_warnings(std::span<const Injection> injections, const Interface& spec,
                                       const std::string& whose = {});

/// One sentence for each parameter of the plant with which it cannot be held, and for each angle of its task that looks
/// like degrees.
std::vector<std::string> plant_warnings(const Setup& setup);

/// One sentence for each parameter whose draws reach values with which the plant cannot be held.
std::vector<std::string> draw_warnings(const Setup& setup, const Randomisation& randomised);

/// What a study may well ask for, but its author should know: one sentence each.
std::vector<std::string> study_warnings(const Study& study);

}  // namespace gust
