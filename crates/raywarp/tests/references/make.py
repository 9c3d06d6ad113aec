"""References of path tracing by Mitsuba 3 (pip install mitsuba numpy), with which tests/references.rs compares pictures.

    python make.py FOLDER [SAMPLES]

writes for each scene an EXR of mean (R, G, B) and variance of one sample (vR, vG, vB). The scenes are those of the test, number by
number. GGX is glTF's: written as a plugin, as Mitsuba's own materials are of other models.
"""

import os
import sys

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
T = mi.ScalarTransform4f
SIDE = 32
DEPTH = 5  # of Mitsuba: three bounces, light looked for at each and at the first hit


class Gltf(mi.BSDF):
    """Appendix B of the specification of glTF 2.0."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.base = mi.Color3f(props.get("base"))
        self.metallic = props.get("metallic", 0.0)
        self.alpha = props.get("roughness", 1.0) ** 2
        self.m_flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
        self.m_components = [self.m_flags]

    def value(self, view, light):
        half = dr.normalize(view + light)
        square = self.alpha * self.alpha
        facets = square / (dr.pi * dr.square(dr.square(half.z) * (square - 1) + 1))
        spread = lambda z: dr.sqrt(dr.square(z) * (1 - square) + square)
        visible = 0.5 / (light.z * spread(view.z) + view.z * spread(light.z))
        toward = dr.power(1 - dr.maximum(dr.dot(view, half), 0), 5)
        dielectric = 0.04 + 0.96 * toward
        metal = self.base + (1 - self.base) * toward
        layer = metal * self.metallic + dielectric * (1 - self.metallic)
        matt = self.base * ((1 - self.metallic) * (1 - dielectric) / dr.pi)
        return (matt + layer * facets * visible) * light.z

    def density(self, view, light):
        facets = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.alpha, True)
        half = dr.normalize(view + light)
        glossy = facets.pdf(view, half) / (4 * dr.maximum(dr.dot(light, half), 1e-9))
        return 0.5 * mi.warp.square_to_cosine_hemisphere_pdf(light) + 0.5 * glossy

    def sample(self, ctx, si, which, where, active=True):
        facets = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.alpha, True)
        half, _ = facets.sample(si.wi, where)
        light = dr.select(which < 0.5, mi.reflect(si.wi, half), mi.warp.square_to_cosine_hemisphere(where))
        good = active & (si.wi.z > 0) & (light.z > 0)
        found = mi.BSDFSample3f()
        found.wo, found.eta, found.sampled_component = light, 1, 0
        found.pdf = dr.select(good, self.density(si.wi, light), 0)
        found.sampled_type = +mi.BSDFFlags.GlossyReflection
        good &= found.pdf > 0
        return found, dr.select(good, self.value(si.wi, light) / found.pdf, 0)

    def eval(self, ctx, si, wo, active=True):
        return dr.select(active & (si.wi.z > 0) & (wo.z > 0), self.value(si.wi, wo), 0)

    def pdf(self, ctx, si, wo, active=True):
        return dr.select(active & (si.wi.z > 0) & (wo.z > 0), self.density(si.wi, wo), 0)

    def eval_pdf(self, ctx, si, wo, active=True):
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def to_string(self):
        return "Gltf"


mi.register_bsdf("gltf", Gltf)


def rgb(*values):
    return {"type": "rgb", "value": list(values)}


def matt(*color):
    return {"type": "diffuse", "reflectance": rgb(*color)}


def gltf(base, metallic, roughness):
    return {"type": "gltf", "base": mi.ScalarColor3f(base), "metallic": metallic, "roughness": roughness}


def lamp(radiance):
    down = T().translate([0, 2.5, 0]).rotate([1, 0, 0], 90).scale(0.6)
    return {"type": "rectangle", "to_world": down, "bsdf": matt(0, 0, 0), "light": {"type": "area", "radiance": rgb(radiance, radiance, radiance)}}


def sky():
    """Bright about one direction, with a gradient from below to above; texel by texel as the test has it."""
    height, width = 256, 512
    rows, columns = np.mgrid[0:height, 0:width]
    polar = (rows + 0.5) / height * np.pi
    angle = ((columns + 0.5) / width - 0.5) * 2 * np.pi
    x, y, z = np.sin(polar) * np.cos(angle), np.cos(polar), np.sin(polar) * np.sin(angle)
    spot = np.exp(8 * (0.48 * x + 0.6 * y + 0.64 * z - 1))
    picture = np.stack([0.3 + 0.2 * y + 6 * spot, 0.4 + 0.2 * y + 5 * spot, 0.6 + 0.2 * y + 3 * spot], -1)
    bitmap = mi.Bitmap(picture.astype(np.float32))
    # The middle of Mitsuba's picture is towards +z, that of ours towards +x.
    return {"type": "envmap", "bitmap": bitmap, "to_world": T().rotate([0, 1, 0], 90)}


FLOOR, BOX = (0.7, 0.5, 0.3), (0.3, 0.6, 0.8)
POINT = {"type": "point", "position": [1.0, 2.0, 1.5], "intensity": rgb(4, 4, 4)}
SUN = {"type": "directional", "direction": [-0.3, -1, -0.2], "irradiance": rgb(2, 2, 2)}
SCENES = {
    "all_matt": (matt(*FLOOR), matt(*BOX), [lamp(8)]),
    "metal": (matt(*FLOOR), gltf(BOX, 1.0, 0.4), [lamp(8)]),
    "dielectric": (gltf(FLOOR, 0.0, 0.3), gltf(BOX, 0.0, 0.6), [lamp(8)]),
    "mixed": (gltf(FLOOR, 0.5, 0.5), gltf(BOX, 0.25, 0.8), [lamp(8)]),
    "rough_glass": (matt(*FLOOR), {"type": "roughdielectric", "distribution": "ggx", "alpha": 0.25, "int_ior": 1.5, "ext_ior": 1.0}, [lamp(8)]),
    "clear_glass": (matt(*FLOOR), {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}, [lamp(8)]),
    "point_and_sun": (gltf(FLOOR, 0.0, 0.5), gltf(BOX, 1.0, 0.6), [POINT, SUN]),
    "sky": (matt(*FLOOR), gltf(BOX, 1.0, 0.3), [sky]),
    "sky_and_lamp": (gltf(FLOOR, 0.0, 0.4), matt(*BOX), [sky, lamp(4)]),
}


def scene(floor, box, lights):
    camera = T().look_at(origin=[3, 2.2, 3.5], target=[0, 0.5, 0], up=[0, 1, 0])
    film = {"type": "hdrfilm", "width": SIDE, "height": SIDE, "rfilter": {"type": "box"}, "pixel_format": "rgb", "component_format": "float32"}
    whole = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": DEPTH, "rr_depth": 1000},
        "sensor": {"type": "perspective", "fov": 40, "fov_axis": "y", "to_world": camera, "film": film},
        "floor": {"type": "rectangle", "to_world": T().rotate([1, 0, 0], -90).scale(2), "bsdf": floor},
        "box": {"type": "cube", "to_world": T().translate([-0.4, 0.55, 0.2]).rotate([0, 1, 0], 30).scale(0.5), "bsdf": box},
    }
    for index, light in enumerate(lights):
        whole[f"light{index}"] = light() if callable(light) else light
    return mi.load_dict(whole)


# Runs of which a scene has a mean each: they tell the variance.
RUNS = 64


def main(folder, samples):
    os.makedirs(folder, exist_ok=True)
    for name, parts in SCENES.items():
        loaded = scene(*parts)
        spp = max(samples // RUNS, 1)
        runs = [np.array(mi.render(loaded, spp=spp, seed=seed), dtype=np.float64) for seed in range(RUNS)]
        mean, variance = np.mean(runs, 0), np.var(runs, 0, ddof=1) * spp
        both = np.concatenate([mean, variance], -1).astype(np.float32)
        names = ["R", "G", "B", "vR", "vG", "vB"]
        bitmap = mi.Bitmap(both, pixel_format=mi.Bitmap.PixelFormat.MultiChannel, channel_names=names)
        bitmap.write(os.path.join(folder, name + ".exr"))
        print(name, mean.mean((0, 1)), flush=True)


main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 8192)
