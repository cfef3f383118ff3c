#include <cstdlib>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/parameters.h"
#include "tests/fuzz/input_file.h"

/// Parameters that are written and read back the same, or a refusal.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const umtet::fuzz::InputFile file(".toml");
  try {
    umtet::Parameters parameters, again;
    parameters.load(file.write(data, size), umtet::ParamSource::File);
    const std::string text = parameters.toml();
    again.load(file.write(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()), umtet::ParamSource::Case);
    for (const char* section : {"cloud", "reconstruct", "mesh"})
      umtet::fuzz::require(parameters.section(section) == again.section(section));
  } catch (const umtet::UsageError&) {
  }
  return 0;
}
