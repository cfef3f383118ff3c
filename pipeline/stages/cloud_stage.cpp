#include <cerrno>
#include <chrono>
#include <fstream>
#include <system_error>

#include "body/scan/sample_merging.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/option_words.h"
#include "pipeline/domain/body_options.h"
#include "pipeline/meshing/defect_files.h"
#include "pipeline/stages/scan_source.h"
#include "pipeline/stages/stages.h"
#include "reconstruct/io/input_file.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/io/triangle_mesh_io.h"

namespace umtet {
namespace fs = std::filesystem;

void run_cloud_stage(const StageContext& context, const InputFile& source) {
  const auto start = std::chrono::steady_clock::now();
  context.progress.report("cloud", "read", 0);
  // Files are stamped before they are parsed: if a file changes meanwhile, the next run finds another stamp and reads
  // it again.
  const std::vector<RecordedFile> inputs = source_inputs(source, context.parameters, *context.paths.stamps);
  ScanSource scan = read_source(source, context.parameters, {.cancelled = until_interrupted().cancelled});
  context.progress.report("cloud", "prepare", .2);
  PreparedCloud prepared =
      prepare_merged(std::move(scan.cloud), source.path().string(), body_options(context.parameters));
  if (scan.triangles) add_triangles(*scan.triangles, prepared.report);
  stop_if_interrupted();
  for (const std::string& notice : texts_of(prepared.report.notices, as_flag)) context.progress.say("cloud: " + notice);

  begin_writing(context, Stage::Cloud);
  write_artefact(context.paths.cloud(), [&](const fs::path& temporary) {
    errno = 0;  // streams need not set errno
    std::ofstream out(temporary, std::ios::binary);
    write_ply(out, prepared.cloud);
    out.close();
    if (!out) throw std::system_error(errno ? errno : EIO, std::generic_category(), "stream failed");
  });
  std::vector<std::string> outputs = {"cloud.ply"};
  if (scan.triangles) {
    write_artefact(context.paths.triangles(), [&](const fs::path& temporary) {
      errno = 0;
      std::ofstream out(temporary, std::ios::binary);
      write_ply(out, scan.triangles->boundary);
      out.close();
      if (!out) throw std::system_error(errno ? errno : EIO, std::generic_category(), "stream failed");
    });
    outputs.push_back("triangles.ply");
  }
  if (!prepared.marked.empty()) {
    write_marked(context.paths.folder(Stage::Cloud) / kMarkedFile, prepared.marked);
    outputs.emplace_back(kMarkedFile);
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  StageRun run = run_of_stage(seconds.count(), context.threads);
  run.source = fs::absolute(source.path()).string();
  write_record(context.paths,
               {Stage::Cloud,
                context.parameters.section("cloud"),
                inputs,
                {},
                to_json(prepared.report, wanted_mesh(context.parameters)),
                std::move(run)},
               outputs);
  context.handover.cloud = std::move(prepared.cloud);
  context.handover.near = std::move(prepared.near);
  if (scan.triangles) context.handover.triangles = std::move(scan.triangles->boundary);
}

}  // namespace umtet
