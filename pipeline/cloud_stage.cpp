#include <Eigen/Geometry>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <system_error>

#include "pipeline/stages.h"
#include "reconstruct/point_cloud_io.h"

namespace umtet {
namespace fs = std::filesystem;

RecordedFile source_input(const fs::path& source) {
  const fs::file_status status = fs::status(source);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw CloudRefused(source.string() + ": not a regular file; copy what it yields to a file and give that");
  }
  return {"source", stamp(source)};
}

void run_cloud_stage(const StageContext& context, const fs::path& source) {
  const auto start = std::chrono::steady_clock::now();
  context.progress.report("cloud", "read", 0);
  // Stamped before it is parsed: if the file changes meanwhile, the next run sees other bytes and reads it again.
  const RecordedFile input = source_input(source);
  const CloudFile file = read_point_cloud(source);

  Eigen::AlignedBox3d box;
  for (const Vec3& x : file.cloud.points) box.extend(x);
  begin_writing(context, Stage::Cloud);
  write_artefact(context.paths.cloud(), [&](const fs::path& temporary) {
    errno = 0;  // streams do not promise to set it
    std::ofstream out(temporary, std::ios::binary);
    write_ply(out, file.cloud);
    out.close();
    if (!out) throw std::system_error(errno ? errno : EIO, std::generic_category(), "stream failed");
  });
  const Json numbers = {{"format", file.report.format},
                        {"n_points", file.report.n_points},
                        {"n_normals_rescaled", file.report.n_normals_rescaled},
                        {"box_min", {box.min().x(), box.min().y(), box.min().z()}},
                        {"box_max", {box.max().x(), box.max().y(), box.max().z()}}};
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  Json run = run_block(seconds.count(), context.threads);
  run["source"] = fs::absolute(source).string();
  write_record(context.paths, {Stage::Cloud, context.parameters.section("cloud"), {input}, {}, numbers, std::move(run)},
               {"cloud.ply"});
}

}  // namespace umtet
