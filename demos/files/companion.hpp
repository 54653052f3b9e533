/// @file
/// Programs that the command starts and that other packages bring: recorders of engines, the command with pictures.
#pragma once

#include <string>
#include <string_view>

namespace pd {

/// The full path of a program that stands beside the running one, or in ../libexec/pdepth as installed copies have it.
/// Empty where it is in neither.
[[nodiscard]] std::string companion_program(std::string_view name);

}  // namespace pd
