#include "pipeline/case/record.h"

#include <cstdlib>

#include "tests/fuzz/input_file.h"

using umtet::Json;

/// What is no record of this case is Missing or Damaged, whether its seal holds or not: never an exception.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const struct Folder {
    Folder() { std::filesystem::create_directories(paths.folder(umtet::Stage::Cloud)); }
    ~Folder() { std::filesystem::remove_all(paths.root); }
    umtet::CasePaths paths{.root = std::filesystem::temp_directory_path() /
                                   ("umtet_fuzz_record_" + std::to_string(::getpid()))};
  } folder;
  const std::filesystem::path file = folder.paths.record(umtet::Stage::Cloud);
  const auto inspect = [&](std::string_view text) {
    std::ofstream(file, std::ios::binary) << text;
    umtet::inspect_stage(folder.paths, umtet::Stage::Cloud, Json::object(), std::nullopt);
  };
  const std::string text(reinterpret_cast<const char*>(data), size);
  inspect(text);
  Json json = Json::parse(text, nullptr, false);
  if (json.is_object() && json.contains("run") && json["run"].is_object())
    inspect(umtet::file_text(umtet::sealed(json)));
  return 0;
}
