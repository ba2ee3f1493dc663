// lucerna info [SCENE]: host, driver, limits, extensions; a scene's counts and features; the table of settings.
#include "base/error.hpp"
#include "shared/commands.hpp"
#include "scene/scene.hpp"
#include "settings_page.hpp"

#include <fmt/core.h>

#include <cstdlib>

namespace lucerna::demo {

namespace {

struct InfoOptions {
  CommonOptions common;
  std::string scene;
  bool devices = false, settings = false;
};

/// Lists EGL's devices and their renderers. The first that host egl would try is marked.
int listDevices(const InfoOptions& options) {
  const std::vector<EglDevice> devices = eglDevices();
  const std::vector<std::size_t> order = eglPreference(devices);
  nlohmann::ordered_json json{{"devices", nlohmann::ordered_json::array()}};
  fmt::print("EGL devices; LUCERNA_EGL_DEVICE=N chooses one, else the one marked * is tried first\n");
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const EglDevice& device = devices[i];
    std::string renderer, fault;
    setenv("LUCERNA_EGL_DEVICE", std::to_string(i).c_str(), 1);
    try {
      const auto host = Host::create(HostKind::egl);
      renderer = gl::Context().capabilities().renderer;
    } catch (const Error& error) { fault = error.what(); }
    fmt::print("{} {:<3}{:<11} {}\n", i == order[0] ? '*' : ' ', i, nameOf(device.kind),
               renderer.empty() ? fault : renderer);
    fmt::print("       driver {}, PCI {}, node {}\n", device.driver.empty() ? "unknown" : device.driver,
               device.pci.empty() ? "none" : device.pci, device.node.empty() ? "none" : device.node);
    json["devices"].push_back({{"index", i},
                               {"kind", nameOf(device.kind)},
                               {"first", i == order[0]},
                               {"renderer", renderer},
                               {"fault", fault},
                               {"driver", device.driver},
                               {"pci", device.pci},
                               {"node", device.node},
                               {"video_bytes", device.videoBytes}});
  }
  if (devices.empty()) fmt::print("  none: EGL is missing or enumerates no devices\n");
  options.common.writeJson(json);
  return 0;
}

int runInfo(const InfoOptions& options) {
  options.common.apply();
  if (options.devices) return listDevices(options);
  if (options.settings) {
    fmt::print("{}", settingsPage());
    options.common.writeJson({{"settings", settingsJson()}});
    return 0;
  }
  nlohmann::ordered_json json;
  std::optional<Scene> scene;
  if (!options.scene.empty()) scene = loadScene(options.scene);

  const auto host = options.common.makeHost(false);
  const gl::Context context;
  const gl::Capabilities& c = context.capabilities();
  fmt::print("lucerna {}\nhost        {}\nrenderer    {}\nvendor      {}\nOpenGL      {}\nGLSL        {}\n",
             LUCERNA_VERSION, nameOf(host->kind()), c.renderer, c.vendor, c.version, c.shadingLanguage);
  json["host"] = nameOf(host->kind());
  json["renderer"] = c.renderer;
  json["vendor"] = c.vendor;
  json["opengl"] = c.version;
  json["glsl"] = c.shadingLanguage;
  fmt::print("\nlimits\n");
  for (const auto& [name, value] : c.limits()) {
    fmt::print("  {:<32}{}\n", name, value);
    json["limits"][name] = value;
  }
  fmt::print("\nprobed extensions (of {} there are)\n", c.extensionCount);
  for (const auto& [name, there] : c.probedExtensions()) {
    fmt::print("  {:<32}{}\n", name, there ? "yes" : "no");
    json["extensions"][name] = there;
  }
  if (scene) {
    const glm::dvec3 low = scene->bounds.min + scene->origin, high = scene->bounds.max + scene->origin;
    const int digits = scene->origin == glm::dvec3(0.0) ? 6 : 12;
    fmt::print("\nscene {}\n  {:<32}{}\n  {:<32}{}\n  {:<32}{}\n  {:<32}{}\n  {:<32}{}\n", scene->file.string(),
               "triangles", scene->triangleCount(), "vertices", scene->vertices.size(), "meshes", scene->meshes.size(),
               "materials", scene->materials.size(), "textures", scene->textures.size());
    fmt::print("  {:<32}{} ({} of zero area)\n", "left out, not finite", scene->droppedTriangles,
               scene->degenerateTriangles);
    fmt::print("  {:<32}({:.{}g}, {:.{}g}, {:.{}g}) to ({:.{}g}, {:.{}g}, {:.{}g}), {:.6g} m a unit\n", "bounds", low.x,
               digits, low.y, digits, low.z, digits, high.x, digits, high.y, digits, high.z, digits,
               scene->metresPerUnit);
    for (const Camera& camera : scene->cameras)
      fmt::print("  {:<32}{}\n", "camera", camera.name.empty() ? "default" : camera.name);
    json["scene"] = scene->file.string();
    json["triangles"] = scene->triangleCount();
    json["vertices"] = scene->vertices.size();
    json["meshes"] = scene->meshes.size();
    json["materials"] = scene->materials.size();
    json["textures"] = scene->textures.size();
    json["degenerate_triangles"] = scene->degenerateTriangles;
    json["dropped_triangles"] = scene->droppedTriangles;
    json["bounds"] = {{low.x, low.y, low.z}, {high.x, high.y, high.z}};
    fmt::print("\nneeds\n");
    for (const auto& [name, needed] : analyse(*scene).named()) {
      fmt::print("  {:<32}{}\n", name, needed ? "yes" : "left out");
      json["features"][name] = needed;
    }
  }
  options.common.writeJson(json);
  return 0;
}

}  // namespace

Work addInfo(Command app) {
  auto options = std::make_shared<InfoOptions>();
  app.addOption("SCENE", options->scene, "a scene file (JSON, OBJ, glTF, PLY, ...), or the name of a shipped scene")
      .scene();
  app.addFlag("--devices", options->devices, "list EGL's devices and mark the one that is tried first");
  app.addFlag("--settings", options->settings,
              "print every setting and deviation, with ranges, defaults, units and sources (docs/settings.md)");
  options->common.declare(app);
  return [options] { return runInfo(*options); };
}

}  // namespace lucerna::demo
