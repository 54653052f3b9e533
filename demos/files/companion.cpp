#include "files/companion.hpp"

#include <filesystem>
#include <system_error>

namespace pd {

std::string companion_program(std::string_view name) {
  std::error_code error;
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  for (const std::filesystem::path& folder : {here, here.parent_path() / "libexec" / "pdepth"}) {
    if (std::filesystem::exists(folder / name, error)) return folder / name;
  }
  return {};
}

}  // namespace pd
