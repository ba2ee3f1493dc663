// Inside of Hemicubes: one class per method to find the patch that each pixel sees.
#pragma once

#include "gl/pass.hpp"
#include "gl/read_back.hpp"
#include "radiosity/form_factor_rows.hpp"
#include "radiosity/hemicube_batch.hpp"

#include <memory>

namespace lucerna {

class RayScene;

class HemicubeMethod {
 public:
  explicit HemicubeMethod(HemicubeBatch& batch) : batch_(batch) {}
  virtual ~HemicubeMethod() = default;
  HemicubeMethod(const HemicubeMethod&) = delete;
  HemicubeMethod& operator=(const HemicubeMethod&) = delete;

  /// Finds the patch that each pixel sees, and the large patches, which later passes visit pixel row by pixel row.
  virtual void findVisible(const HemicubeRange& range) = 0;
  /// Dispatches the current program over all patches that may have pixels.
  virtual void dispatchOverPatches(const gl::ComputePass& pass, const HemicubeRange& range) const = 0;
  /// Reads the factors by pixels into DrawnHemicubes::factors or kept.
  virtual void readFactors(gl::Staging& staging, DrawnHemicubes& drawn) const = 0;
  virtual std::size_t gpuBytes() const { return 0; }

 protected:
  HemicubeBatch& batch_;
};

/// A rasteriser in compute shaders: all triangles over all pixels, which store the nearest depth.
class RasterMethod : public HemicubeMethod {
 public:
  RasterMethod(gl::ProgramLibrary& programs, HemicubeBatch& batch);
  void findVisible(const HemicubeRange& range) override;
  void dispatchOverPatches(const gl::ComputePass& pass, const HemicubeRange& range) const override;
  void readFactors(gl::Staging& staging, DrawnHemicubes& drawn) const override;

 private:
  const gl::Program &points_, &depth_, &depthLarge_, &pointFactors_;
};

/// Methods whose pixels name their patches: these are listed once each, and only they are visited later.
class ListingMethod : public HemicubeMethod {
 public:
  explicit ListingMethod(HemicubeBatch& batch);
  void dispatchOverPatches(const gl::ComputePass& pass, const HemicubeRange& range) const override;
  void readFactors(gl::Staging& staging, DrawnHemicubes& drawn) const override;
  std::size_t gpuBytes() const override { return list_.bytes(); }

 protected:
  /// Begins the list with the small sources, whether pixels see them or not.
  void startList(const HemicubeRange& range);
  /// Dispatches the current program over all pixels.
  void dispatchOverPixels(const gl::ComputePass& pass, const HemicubeRange& range) const;

 private:
  gl::Buffer list_;
};

/// One ray through each pixel's centre.
class RayMethod : public ListingMethod {
 public:
  RayMethod(gl::ProgramLibrary& programs, HemicubeBatch& batch, const RayScene& rays);
  void findVisible(const HemicubeRange& range) override;

 private:
  const RayScene& rays_;
  const gl::Program& trace_;
};

/// Patch numbers drawn by the GPU's rasteriser, a layer for each face.
class ItemBufferMethod : public ListingMethod {
 public:
  ItemBufferMethod(gl::ProgramLibrary& programs, HemicubeBatch& batch);
  void findVisible(const HemicubeRange& range) override;
  std::size_t gpuBytes() const override { return ListingMethod::gpuBytes() + items_.bytes() + depth_.bytes(); }

 private:
  void drawItems(const HemicubeRange& range) const;

  gl::Texture items_, depth_;
  gl::Framebuffer target_;
  gl::VertexArray noAttributes_;
  const gl::Program &draw_, &listItems_;
};

/// `rays` is needed for HemicubeVisibility::rays.
std::unique_ptr<HemicubeMethod> makeHemicubeMethod(HemicubeVisibility visibility, gl::ProgramLibrary& programs,
                                                   HemicubeBatch& batch, const RayScene* rays);

}  // namespace lucerna
