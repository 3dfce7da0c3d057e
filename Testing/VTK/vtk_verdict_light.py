# SPDX-License-Identifier: BSD-3-Clause
"""Light and gradient opacity."""
import vtk

import vtk_verdict_data as made
from vtk_verdict import FIXED, Different, Same, case, pair
from vtk_verdict_cuts import planes
from vtk_verdict_data import image, look

SOLID = (0, 0), (50, 0), (75, 0.3), (255, 0.3)
EDGES = (0, 0), (10, 0.1), (30, 1)
# A sample's colour stays below 1, beyond which VTK's mapper cuts it off and ours adds it up.
SHINY = dict(Ambient=0.1, Diffuse=0.5, Specular=0.4, SpecularPower=10)
MATTE = dict(Ambient=0, Diffuse=1, Specular=0)


def lit(**options):
    return look(alpha=options.pop("alpha", SOLID), shade=True, **{**SHINY, **options})


def lights(*made_lights):
    def scene(renderer):
        renderer.SetAutomaticLightCreation(0)
        for light in made_lights:
            renderer.AddLight(light)

    return scene


def lamp(kind="SceneLight", **settings):
    light = vtk.vtkLight()
    getattr(light, "SetLightTypeTo" + kind)()
    for name, value in settings.items():
        getattr(light, "Set" + name)(*value) if isinstance(value, tuple) else getattr(light, "Set" + name)(value)
    return light


def one_sided(scene):
    def both(renderer):
        scene(renderer)
        renderer.SetTwoSidedLighting(0)

    return both


@case("TestFixedPointRayCastLightComponents")
def light_components():
    def shone(ambient):
        head = lamp("Headlight", AmbientColor=ambient, DiffuseColor=(0.5, 0.5, 0.5), SpecularColor=(0, 0, 1))
        return pair(image(made.ball()), lit(unit=2), kind=FIXED, scene=lights(head), step=0.2)

    return Different([shone((0, 0, 0))], [shone((1, 1, 1))])


@case("TestGPURayCastPositionalLights")
def lamps():
    shared = dict(Positional=1, AmbientColor=(0, 0, 0), SpecularColor=(1, 1, 1), ConeAngle=60, FocalPoint=(19, 19, 19))
    both = lamp(DiffuseColor=(1, 0, 0), Position=(19, 19, 80), **shared), lamp(DiffuseColor=(0, 1, 0), Position=(80, 19, 19), **shared)
    scene = lights(*both)
    return Different([pair(image(), lit(), scene=scene, step=0.2)], [pair(image(), lit(**MATTE), scene=one_sided(scene), step=0.2)])


def light_kit(**options):
    def scene(renderer):
        kit = vtk.vtkLightKit()
        for name, value in options.items():
            getattr(kit, "Set" + name)(value)
        kit.AddLightsToRenderer(renderer)

    return scene


@case("TestGPURayCastVolumeLightKit")
def warm_light_kit():
    scene = light_kit(KeyLightWarmth=1, FillLightWarmth=0, BackLightWarmth=0)
    return Same(pair(image(), lit(**MATTE), scene=one_sided(scene), step=0.2))


@case("TestGPURayCastGradientOpacity")
def gradient_opacity():
    return Same(*(pair(image(), lit(**options), step=0.2) for options in (dict(gradient=EDGES), dict())))


@case("TestGPURayCastGradientOpacityLight")
def gradient_opacity_light_kit():
    scenes = light_kit(), one_sided(light_kit())
    materials = {}, MATTE
    looks = (lit(gradient=EDGES, **material) for material in materials)
    return Different(*([pair(image(), shown, scene=scene, step=0.2)] for shown, scene in zip(looks, scenes)))


@case("TestGPURayCastShadedClipping")
def shaded_clipping():
    cut = planes(((19, 0, 0), (0.8, 0, 0)))
    clipped = lit(UseClippedVoxelIntensity=1, ClippedVoxelIntensity=-100)
    return Same(pair(image(), lit(), cut, step=0.1), pair(image(), clipped, cut, step=0.1))
