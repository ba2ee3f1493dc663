#include "lpv/receivers.hpp"

#include "base/error.hpp"
#include "forward/light_views.hpp"
#include "gl/pass.hpp"
#include "gl/pieces.hpp"
#include "lpv/grid.hpp"
#include "rays/light_table.hpp"
#include "shared/bindings.h"
#include "shared/lpv_receivers.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

// GL_SHADER_STORAGE_BUFFER
constexpr GLuint kSlotsBuffer = 1, kKeptBuffer = 2, kAroundBuffer = 2, kWorkBeforeBuffer = 3;
constexpr GLuint kSlotsUnit = 7, kKeysUnit = 1, kSeenUnit = 6;  // where rays are traced, 0 has the materials
constexpr std::uint32_t kSegmentsOfAll = 64;  // of a path that meets no receivers; it misses a share of albedo^64
constexpr float kWiderBand = 2.0f;  // than lpv.blend: cascades differ more where they are not joined
constexpr std::uint32_t kSoftwareTurns = 2000, kMostTurns = 1u << 16;  // like the path tracer's, less one segment
constexpr std::size_t kMostPaths = std::size_t{1} << 20;  // per submission
constexpr std::size_t kKeyPixels = std::size_t{1} << 23;  // number that a key distinguishes

float largest(const glm::vec3& v) { return std::max({v.x, v.y, v.z}); }

/// Typical irradiance from lamps, emissive surfaces and the sky.
float typicalOf(const Scene& scene) {
  constexpr float kPi = 3.14159265f;
  float result = analyse(scene).anyLight() ? typicalIrradiance(scene) : 0.0f;
  for (const Material& material : scene.materials) result = std::max(result, kPi * largest(material.emission));
  if (scene.environment) {
    const glm::dvec3 mean = scene.environment->picture ? meanRadiance(*scene.environment->picture) : glm::dvec3(1.0);
    result = std::max(result, kPi * largest(scene.environment->radiance * glm::vec3(mean)));
  }
  return result > 0.0f ? std::clamp(result, 1e-30f, 1e30f) : 1.0f;
}

/// Whether the camera jumped, so that there is no previous picture to stay consistent with.
bool isCut(const Cascade& before, const Cascade& now) {
  constexpr std::int64_t kCells = 4;
  const glm::i64vec3 moved = glm::abs(now.firstCell - before.firstCell);
  return std::max({moved.x, moved.y, moved.z}) > kCells;
}

}  // namespace

bool LpvReceivers::isNeeded(const SceneNeeds& needs, const LpvSettings& settings, Light light) {
  if (settings.transport == LpvTransport::gather) return LightGather::partsOf(needs, settings, light).any();
  const bool extended = needs.emission || needs.environment;
  return light == Light::direct ? extended : needs.indirect || extended;
}

LpvReceivers::LpvReceivers(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Scene& scene,
                           const glm::dvec3& origin, const LpvSettings& settings, Light light)
    : settings_(settings),
      programs_(&programs),
      scene_(scene, analyse(scene), capabilities, PathScene::Settings{true, true, {}}),
      rayOrigin_(scene_.origin() - origin),
      referenceIrradiance_(typicalOf(scene)),
      clearTexture_(capabilities.clearTexture),
      cached_(settings.bounces == LpvSettings::kAllBounces && light != Light::direct) {
  CHECK(settings.rays >= 1 && settings.rays <= LPV_LANES && LPV_LANES % settings.rays == 0, "rays = {}", settings.rays);
  // Slots of the grids, and the maximum number of receivers in them.
  const auto cells = static_cast<std::size_t>(settings.cascades.cells),
             cascades = static_cast<std::size_t>(settings.cascades.cascades);
  const int layers = settings.cascades.cells * settings.cascades.cascades * LPV_FACES;
  if (layers > capabilities.max3dTextureSize)
    throwMissingCapability(
        "lpv.cells={}: receivers take {} layers of a 3D texture; this driver has at most {} (GL_MAX_3D_TEXTURE_SIZE)",
        settings.cascades.cells, layers, capabilities.max3dTextureSize);
  const int lanes = settings.transport == LpvTransport::rays ? settings.rays : LPV_LANES;  // per receiver
  slots_ = cells * cells * cells * cascades * LPV_FACES;
  // Surfaces cross a grid in about cells^2 cells; times four, for the faces that each normal covers.
  capacity_ = std::min(slots_, 24 * cells * cells * cascades);

  // Allocate tables, receivers and their irradiance.
  const auto words = [&](const std::string& name, std::size_t count) {
    if (count > static_cast<std::size_t>(capabilities.maxTextureBufferSize))
      throwMissingCapability(
          "{}: {} texels; this driver's texture buffers have at most {} (GL_MAX_TEXTURE_BUFFER_SIZE)", name, count,
          capabilities.maxTextureBufferSize);
    return gl::BufferTexture(name, gl::Format::r32ui, count * sizeof(GLuint), nullptr, gl::Usage::dynamicCopy);
  };
  slotTable_ = words("lpv slots", slots_);
  keys_ = words("lpv keys", slots_);
  seen_ = words("lpv seen", capacity_);
  for (gl::Buffer& buffer : receivers_)
    buffer = gl::Buffer("lpv receivers", capacity_ * sizeof(shared::LpvReceiver), nullptr, gl::Usage::dynamicCopy);
  for (gl::Buffer& buffer : work_)
    buffer = gl::Buffer("lpv receivers' work", kWorkWords * sizeof(GLuint), nullptr, gl::Usage::dynamicCopy);
  lit_ = gl::Buffer("lpv lit receivers",
                    std::min(capacity_, kMostPaths / static_cast<std::size_t>(lanes)) * sizeof(GLuint), nullptr,
                    gl::Usage::dynamicCopy);
  for (gl::Buffer* buffer : {&lpvConstants_, &lpvConstantsBefore_})
    *buffer = gl::Buffer("lpv constants", sizeof(shared::LpvConstants), nullptr, gl::Usage::dynamicDraw);
  constants_ =
      gl::Buffer("lpv receiver constants", sizeof(shared::LpvReceiverConstants), nullptr, gl::Usage::dynamicDraw);
  pathConstants_ = gl::Buffer("lpv path constants", sizeof(shared::PathConstants), nullptr, gl::Usage::dynamicDraw);
  const gl::Sampling linear{gl::Filter::linear, gl::Filter::linear, gl::Wrap::border};
  irradiance_ = gl::Texture("lpv received irradiance",
                            settings.storage == LpvSettings::Storage::full ? gl::Format::rgba32f : gl::Format::rgba16f,
                            glm::ivec3(settings.cascades.cells, settings.cascades.cells, layers), linear);
  // An empty list is one point long: mark always has it bound.
  aroundPoints_ = gl::Buffer("lpv points around the camera",
                             static_cast<std::size_t>(std::max(settings.around, 1)) * sizeof(shared::LpvAroundPoint),
                             nullptr, gl::Usage::dynamicCopy);
  ring_ = std::make_unique<gl::ReadBackRing>("lpv receiver counts", kWorkWords * sizeof(GLuint));

  // Select the light that paths carry, and the programs of every transport.
  scene_.fill(path_);
  path_.minScatterings = light == Light::indirect ? 2 : 1;
  path_.maxScatterings = light == Light::direct ? 1
                         : settings.bounces == LpvSettings::kAllBounces
                             ? 0xffffu
                             : static_cast<std::uint32_t>(settings.bounces) + 1;
  path_.turns = capabilities.softwareRenderer ? kSoftwareTurns : kMostTurns;

  const gl::ShaderFlags common = lookupFlags(settings);
  const gl::ShaderFlags rays = rayFlags(lanes);
  mark_ = &programs.loadCompute("lpv mark receivers", "lpv/receivers/mark.comp", with(common, {{"CLAIM", 0}}));
  claim_ = &programs.loadCompute("lpv claim receivers", "lpv/receivers/mark.comp", with(common, {{"CLAIM", 1}}));
  keep_ = &programs.loadCompute("lpv keep receivers", "lpv/receivers/keep.comp", common);
  list_ = &programs.loadCompute("lpv list receivers", "lpv/receivers/list.comp", rays);
  if (settings.transport == LpvTransport::rays)
    paths_ = &programs.loadCompute("lpv paths", "lpv/receivers/paths.comp",
                                   with(rays, {{"CACHED", cached_}, {"FROM_CELLS", 0}}));
  if (settings.around > 0)
    around_ = &programs.loadCompute("lpv points around the camera", "lpv/receivers/around.comp", rays);
  store_ = &programs.loadCompute("lpv store receivers", "lpv/receivers/store.comp", common);
  if (settings.transport == LpvTransport::gather)
    gather_ = std::make_unique<LightGather>(programs, capabilities, scene, origin, settings, light, scene_, common);
  forget();
}

gl::ShaderFlags LpvReceivers::lookupFlags(const LpvSettings& settings) {
  return {{"LPV_FULL_FLOAT", settings.storage == LpvSettings::Storage::full}};
}

gl::ShaderFlags LpvReceivers::rayFlags(int lanes) const {
  return with(with(lookupFlags(settings_), scene_.flags()),
              {{"LINEAR_SEEDS", 0}, {"GLOSSY", 0}, {"SHARED_STACK", scene_.rays().sharedStack()}, {"PATHS", lanes}});
}

void LpvReceivers::forget() {
  slotTable_.clear();
  seen_.clear();
  for (gl::Buffer& buffer : work_) buffer.upload(0, kWorkWords * sizeof(GLuint), noWork().data());
  const std::array<const gl::Texture*, 1> textures{&irradiance_};
  gl::clearToZero(textures, clearTexture_);
  cascades_.clear();
  counts_ = {};
  if (gather_) gather_->forget();
}

void LpvReceivers::place(const Inputs& inputs) {
  shared::LpvConstants lpv = lpvConstants(settings_, inputs.cascades, referenceIrradiance_);
  lpv.blendBand = std::min(kWiderBand * lpv.blendBand, 1.0f);
  std::swap(lpvConstants_, lpvConstantsBefore_);
  lpvConstants_.upload(0, sizeof lpv, &lpv);
  if (cascades_.empty()) lpvConstantsBefore_.upload(0, sizeof lpv, &lpv);
  shared::LpvReceiverConstants constants{};
  for (std::size_t k = 0; k < inputs.cascades.size(); ++k)
    constants.firstCell[k] = glm::ivec4(glm::ivec3(inputs.cascades[k].firstCell), 0);
  constants.rayOrigin = glm::vec3(rayOrigin_);
  constants.frame = ++frame_;
  constants.capacity = static_cast<std::uint32_t>(capacity_);
  constants.mostSegments = std::min(
      path_.maxScatterings, settings_.bounces == LpvSettings::kAllBounces ? kSegmentsOfAll : path_.maxScatterings);
  const glm::ivec2 size = inputs.visible.size();
  const std::size_t pixels = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
  constants.around = inputs.fades ? static_cast<std::uint32_t>(settings_.around) : 0;
  constants.markEvery = static_cast<std::uint32_t>(pixels / (kKeyPixels - constants.around) + 1);
  constants_.upload(0, sizeof constants, &constants);

  const Camera& camera = inputs.camera;
  const glm::dvec3 right = glm::normalize(glm::cross(camera.direction, camera.up)),
                   up = glm::cross(right, camera.direction);
  const double pixel = 2.0 * std::tan(0.5 * camera.verticalFov) / size.y;
  path_.cameraPosition = glm::vec3(camera.position - rayOrigin_);
  path_.pixelRight = glm::vec3(pixel * right);
  path_.pixelUp = glm::vec3(pixel * up);
  path_.firstPixel = glm::vec3(camera.direction - 0.5 * size.x * pixel * right - 0.5 * size.y * pixel * up);
  path_.picture = glm::ivec4(size, 0, 0);
  pathConstants_.upload(0, sizeof path_, &path_);
}

void LpvReceivers::bindReceivers() const {
  lpvConstants_.bindUniform(BLOCK_LPV);
  constants_.bindUniform(BLOCK_RECEIVERS);
  pathConstants_.bindUniform(BLOCK_RECEIVER_PATHS);
  receivers_[0].bindStorage(kReceiversBuffer);
  work_[0].bindStorage(kWorkBuffer);
}

// After the grids have moved, copies receivers that are still inside to a new list and enters them in the slots.
void LpvReceivers::keep() {
  std::swap(receivers_[0], receivers_[1]);
  std::swap(work_[0], work_[1]);
  work_[0].upload(0, kWorkWords * sizeof(GLuint), noWork().data());
  slotTable_.clear();
  const gl::ComputePass pass("lpv keep receivers", gl::Barrier::storage | gl::Barrier::textureFetch);
  keep_->use();
  bindReceivers();
  receivers_[1].bindStorage(kReceiversBuffer);
  receivers_[0].bindStorage(kKeptBuffer);
  slotTable_.buffer().bindStorage(kSlotsBuffer);
  work_[1].bindStorage(kWorkBeforeBuffer);
  pass.dispatchIndirect(work_[1]);
}

// Finds the points around the camera, unless they are those of the frame before.
void LpvReceivers::lookAround() {
  if (!around_ || aroundFrom_ == path_.cameraPosition) return;
  const gl::ComputePass pass("lpv points around the camera", gl::Barrier::storage);
  around_->use();
  bindReceivers();
  scene_.bind();
  aroundPoints_.bindStorage(kReceiversBuffer);
  pass.dispatch(glm::ivec3(settings_.around, 1, 1), glm::ivec3(64, 1, 1));
  aroundFrom_ = path_.cameraPosition;
}

void LpvReceivers::mark(const Inputs& inputs) {
  if (inputs.fades) lookAround();
  keys_.buffer().clear(0xffffffffu);
  const glm::ivec2 picture = inputs.visible.size();
  const int rowsAround = inputs.fades ? (settings_.around + picture.x - 1) / picture.x : 0;
  const glm::ivec3 size(picture.x, picture.y + rowsAround, 1), group(8, 8, 1);
  {
    const gl::ComputePass pass("lpv mark receivers", gl::Barrier::storage | gl::Barrier::textureFetch);
    mark_->use();
    bindReceivers();
    inputs.visible.bind(*mark_, inputs.worldFromClip);
    slotTable_.bind(kSlotsUnit);
    seen_.buffer().bindStorage(kReceiversBuffer);
    keys_.buffer().bindStorage(kSlotsBuffer);
    aroundPoints_.bindStorage(kAroundBuffer);
    pass.dispatch(size, group);
  }
  const gl::ComputePass pass("lpv claim receivers",
                             gl::Barrier::storage | gl::Barrier::textureFetch | gl::Barrier::command);
  claim_->use();
  bindReceivers();
  inputs.visible.bind(*claim_, inputs.worldFromClip);
  slotTable_.bind(kSlotsUnit);
  keys_.bind(kKeysUnit);
  slotTable_.buffer().bindStorage(kSlotsBuffer);
  aroundPoints_.bindStorage(kAroundBuffer);
  pass.dispatch(size, group);
}

// Lists visible receivers with fewer paths than `target`.
void LpvReceivers::list(int target, bool countsFading) {
  std::array<GLuint, kWorkWords> none = noWork();
  none[kFrame] = frame_;
  work_[0].upload(kWaiting * sizeof(GLuint), (kWorkWords - kWaiting) * sizeof(GLuint), &none[kWaiting]);
  bindReceivers();
  lpvConstantsBefore_.bindUniform(BLOCK_LPV);  // new receivers look up the light shown in their place before
  irradiance_.bind(UNIT_RECEIVED);
  scene_.bind();
  lit_.bindStorage(kSlotsBuffer);
  const gl::ComputePass pass("lpv list receivers", gl::Barrier::storage | gl::Barrier::command);
  list_->use();
  list_->set("mostLit", static_cast<unsigned>(lit_.bytes() / sizeof(GLuint)));
  list_->set("pathTarget", static_cast<unsigned>(target));
  list_->set("countsFading", countsFading ? 1 : 0);
  slotTable_.bind(kSlotsUnit);
  seen_.bind(kSeenUnit);
  pass.dispatchIndirect(work_[0]);
  lpvConstants_.bindUniform(BLOCK_LPV);
}

std::array<GLuint, LpvReceivers::kWorkWords> LpvReceivers::noWork() {
  std::array<GLuint, kWorkWords> words{0, 1, 1};
  for (std::size_t part = kLitGroups; part < kWorkWords; part += 3) words[part + 1] = words[part + 2] = 1;
  return words;
}

void LpvReceivers::dispatchListed(const gl::ComputePass& pass, const gl::Program& program, const gl::Buffer& work) {
  for (unsigned part = 0; part < LPV_PARTS; ++part) {
    program.set("firstGroup", part * LPV_PART_GROUPS);
    pass.dispatchIndirect(work, (kLitGroups + 3 * part) * sizeof(GLuint));
  }
}

void LpvReceivers::light(int target) {
  list(target);
  const gl::ComputePass pass("lpv paths", gl::Barrier::storage);
  paths_->use();
  irradiance_.bind(UNIT_RECEIVED);
  gl::Submission::add(mostTurns());
  dispatchListed(pass, *paths_, work_[0]);
}

// New receivers gather all their light; then they are final while the maps stay.
void LpvReceivers::gather(const Inputs& inputs) {
  bindReceivers();
  gather_->update(inputs.maps, inputs.mapsAreNew);
  list(1);
  gather_->gather(inputs.maps, work_[0], kLitGroups * sizeof(GLuint), lit_.bytes() / sizeof(GLuint));
}

void LpvReceivers::store(float mostChange) {
  const std::array<const gl::Texture*, 1> textures{&irradiance_};
  gl::clearToZero(textures, clearTexture_);
  const gl::ComputePass pass("lpv store receivers", gl::Barrier::storage | gl::Barrier::textureFetch,
                             gl::Barrier::image);
  store_->use();
  store_->set("enoughPaths", static_cast<unsigned>(std::min(settings_.samples, settings_.leastRays)));
  store_->set("mostChange", mostChange);
  bindReceivers();
  slotTable_.bind(kSlotsUnit);
  irradiance_.bindImage(0, gl::Access::write);
  pass.dispatchIndirect(work_[0]);
}

void LpvReceivers::update(const Inputs& inputs, int rounds) {
  const bool moved = !cascades_.empty() &&
                     !std::equal(cascades_.begin(), cascades_.end(), inputs.cascades.begin(), inputs.cascades.end(),
                                 [](const Cascade& a, const Cascade& b) { return a.firstCell == b.firstCell; });
  const bool cut = cascades_.empty() || isCut(cascades_.front(), inputs.cascades.front());
  const float mostChange = inputs.fades && !cut ? settings_.mostChange : 0.0f;
  place(inputs);
  cascades_ = inputs.cascades;
  if (moved) keep();
  mark(inputs);
  if (settings_.transport == LpvTransport::gather) {
    gather(inputs);
    store(mostChange);
    list(1, true);
    ring_->copy(work_[0]);
    return;
  }
  for (int round = 0; round < rounds; ++round) {
    if (cached_ && round > 0) store(mostChange);
    light(settings_.samples);
  }
  for (int paths = rounds * settings_.rays; paths < std::min(settings_.leastRays, settings_.samples);
       paths += settings_.rays)
    light(settings_.leastRays);
  store(mostChange);
  list(settings_.samples, true);  // the remaining work
  ring_->copy(work_[0]);
}

void LpvReceivers::bindForLookup() const {
  lpvConstants_.bindUniform(BLOCK_LPV);
  constants_.bindUniform(BLOCK_RECEIVERS);
  irradiance_.bind(UNIT_RECEIVED);
}

std::vector<AskedPart> LpvReceivers::ask(const glm::vec3& position, const glm::vec3& normal) const {
  const AskedParts parts(24 * LPV_MAX_CASCADES);
  {
    const gl::Program& program =
        programs_->loadCompute("lpv ask receivers", "lpv/receivers/ask.comp", lookupFlags(settings_));
    const gl::ComputePass pass("lpv ask receivers");
    program.use();
    bindReceivers();
    bindForLookup();
    slotTable_.bind(kSlotsUnit);
    program.set("askedPosition", position);
    program.set("askedNormal", normal);
    parts.bind();
    pass.dispatch(glm::ivec3(1), glm::ivec3(1));
  }
  return parts.read();
}

std::vector<LpvReceivers::Shown> LpvReceivers::shown() const {
  const std::size_t count = std::min<std::size_t>(work_[0].read<GLuint>()[kWanted], capacity_);
  std::vector<Shown> result;
  if (count == 0) return result;
  for (const shared::LpvReceiver& r : receivers_[0].read<shared::LpvReceiver>(count)) {
    if (r.triangle == LPV_UNPLACED || r.triangle == LPV_NOWHERE || r.paths == 0) continue;
    result.push_back(
        {r.position, r.normal, r.shown, r.presence, glm::ivec3(r.cell), r.cell.w / LPV_FACES, r.cell.w % LPV_FACES});
  }
  return result;
}

void LpvReceivers::collect(bool wait) {
  for (std::vector<GLuint> words = ring_->fetch(wait); !words.empty(); words = ring_->fetch(wait)) {
    counts_.receivers = std::min<std::uint64_t>(words[kWanted], capacity_);
    counts_.left = words[kWanted] - counts_.receivers;
    counts_.waiting = words[kWaiting];
    counts_.frame = words[kFrame];
  }
}

std::size_t LpvReceivers::mostFrames() const {
  const std::size_t lit = lit_.bytes() / sizeof(GLuint), lists = (capacity_ + lit - 1) / lit;
  const auto paths = static_cast<std::size_t>(settings_.rays);
  const std::size_t each = settings_.transport == LpvTransport::gather
                               ? 1
                               : (static_cast<std::size_t>(settings_.samples) + paths - 1) / paths;
  return (lists + 1) * each + 1;
}

double LpvReceivers::mostTurns() const {
  if (gather_) return gather_->mostTurns();
  return static_cast<double>(lit_.bytes() / sizeof(GLuint)) * settings_.rays * kTurnsOfPath;
}

std::size_t LpvReceivers::gpuBytes() const {
  std::size_t bytes = scene_.gpuBytes() + lpvConstants_.bytes() + lpvConstantsBefore_.bytes() + constants_.bytes() +
                      pathConstants_.bytes() + lit_.bytes() + slotTable_.bytes() + keys_.bytes() + seen_.bytes() +
                      irradiance_.bytes() + aroundPoints_.bytes() + ring_->bytes() +
                      (gather_ ? gather_->gpuBytes() : 0);
  for (std::size_t i = 0; i < 2; ++i) bytes += receivers_[i].bytes() + work_[i].bytes();
  return bytes;
}

}  // namespace lucerna
