#include "pipeline/output/detail/triangle_scene.h"

#include "pipeline/output/detail/scene_blocks.h"

namespace umtet::detail {

ReportScene triangle_scene(const std::vector<Vec3>& V, const std::vector<Triangle>& F, const Vec3& shift,
                           std::size_t most, const std::vector<VertexField>& fields) {
  ReportScene scene;
  SceneHead& head = scene.head;
  std::vector<FacedTet> faces;
  for (const Triangle& f : F) faces.push_back({f[0], f[1], f[2], f[0]});
  Box box;
  for (const Triangle& f : F)
    for (const int v : f) box.extend(V[v]);
  head.n_faces = faces.size();
  if (faces.size() > most) coarsen_faces(V, box.min(), most, faces);
  head.n_faces_shown = faces.size();
  std::vector<int> id(V.size(), -1), shown;
  for (FacedTet& f : faces) {
    for (int k = 0; k < 3; ++k) {
      if (id[f[k]] < 0) {
        id[f[k]] = static_cast<int>(shown.size());
        shown.push_back(f[k]);
      }
    }
    f = {id[f[0]], id[f[1]], id[f[2]], id[f[0]]};
  }
  if (!faces.empty()) {
    head.box_min = box.min() + shift;
    head.box_size = box.sizes();
  }
  head.index_bytes = index_bytes_for(shown.size());
  std::vector<Vec3> positions;
  for (const int v : shown) positions.push_back(V[v] + shift);
  scene.blocks = {{"positions", position_block(positions, head.box_min, head.box_size)},
                  {"faces", index_block(faces, head.index_bytes)}};
  for (const VertexField& field : fields) {
    std::vector<std::uint8_t> bytes;
    for (const int v : shown) bytes.push_back(in_known_steps(field.values[v], field.range.least, field.range.most));
    scene.blocks.emplace_back("vertex_field_" + std::to_string(head.fields.size()), byte_block(bytes));
    head.fields.push_back({field.name, field.range});
  }
  return scene;
}

std::vector<int> order_of_use(const std::vector<Triangle>& F, std::size_t n_vertices) {
  std::vector<char> is_used(n_vertices, 0);
  std::vector<int> order;
  for (const Triangle& f : F) {
    for (const int v : f) {
      if (is_used[v]) continue;
      is_used[v] = 1;
      order.push_back(v);
    }
  }
  return order;
}

}  // namespace umtet::detail
