# SPDX-License-Identifier: BSD-3-Clause
"""Several volumes that overlap, streamed textures, pictures as images, windows, picking, and shaders of the prop's own."""
import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import stratus
import vtk_verdict_data as made
from vtk_verdict import BACKGROUND, FIXED, GPU, OURS, SIZE, STEP, Different, Same, case, fine, look_at, nothing, pair, pixels, \
    refusal, render, renderers, volume_of
from vtk_verdict_cuts import planes
from vtk_verdict_data import image, look
from vtk_verdict_masks import two_dimensional
from vtk_verdict_surfaces import sphere


def several(volumes, then=nothing, settings=nothing, step=STEP):
    """The pair of pictures of volumes (data, property, place), by vtkMultiVolume and by ours. then(prop, mapper): changes made after a
    first picture."""
    pictures = []
    for ours in False, True:
        prop = stratus.vtkStratusMultiVolume() if ours else vtk.vtkMultiVolume()
        shared = None
        if not ours:
            shared = GPU()
            fine(shared, step)
            settings(shared)
            prop.SetMapper(shared)
        for port, (data, shown, place) in enumerate(volumes):
            mapper = stratus.vtkStratusVolumeMapper() if ours else None
            volume = vtk.vtkVolume()
            volume.SetProperty(shown)
            place(volume)
            if ours:
                fine(mapper, STEP)
                settings(mapper)
                mapper.SetInputDataObject(data)
                volume.SetMapper(mapper)
            else:
                producer = vtk.vtkTrivialProducer()
                producer.SetOutput(data)
                shared.SetInputConnection(port, producer.GetOutputPort())
            prop.SetVolume(volume, port)
        with renderers() as renderer:
            renderer.AddVolume(prop)
            look_at(renderer, (30, 20, 1.3))
            render()
            if then is not nothing:
                then(prop, shared)
                render()
            pictures.append(pixels())
            if ours and prop.GetLastError():
                raise RuntimeError(prop.GetLastError())
    return tuple(pictures)


def moved(volume):
    volume.SetPosition(9, 6, 12)


def turned(volume):
    volume.SetPosition(-8, 10, 4), volume.RotateZ(30)


def red(**options):
    return look(tints=((0, 0.3, 0, 0), (255, 1, 0.4, 0.1)), **options)


@case("TestGPURayCastMultiVolumeOverlapping")
def overlapping():
    """The third volume reaches its border in the first picture, and ends before it in the second."""
    waves = image(made.waves(24)), look(((100, 0), (270, 0.1)), made.WAVE_TINTS), turned
    ending = image(made.blobs(24)), look(tints=made.WAVE_TINTS), turned
    return Different(*([several([(image(), look(), nothing), (image(made.ball(30)), red(), moved), third])] for third in (waves, ending)))


@case("TestGPURayCastMultiVolumeAddRemove")
def added_and_removed():
    def then(prop, shared):
        prop.RemoveVolume(1)
        if shared is not None:
            shared.RemoveInputConnection(1, 0)

    return Same(several([(image(), look(), nothing), (image(made.ball(30)), red(), moved)], then))


@case("TestGPURayCastMultiVolumeCellData")
def overlapping_cells():
    return Same(several([(image(cells=True), look(), nothing), (image(made.ball(30)), red(), moved)]))


@case("TestGPURayCastMultiVolumeTransfer2D")
def overlapping_functions():
    """VTK mixes a function of two variables with no volume that lacks gradient opacity."""
    flat = (0, 1), (255, 1)

    def both(unit):
        first = image(), look(alpha=((0, 0), (20, 0), (255, 0.25 * unit)), gradient=flat, unit=unit), nothing
        return several([first, (image(made.ball(30)), two_dimensional(unit), moved)], step=0.25)

    return Different([both(1)], [both(0.25)])


@case("TestGPURayCastTextureStreaming")
def streamed():
    """VTK draws blocks of a texture one after another."""

    def settings(mapper):
        if hasattr(mapper, "SetPartitions"):
            mapper.SetPartitions(2, 1, 2)

    return Different([pair(image(), look(), settings)], [pair(image(), look())])


def to_images(camera=nothing):
    """The colours, over the background, and the depths of both as pictures."""
    colors, depths = [], []
    for kind in GPU, stratus.vtkStratusVolumeMapper:
        mapper = kind()
        mapper.SetInputDataObject(image())
        fine(mapper, STEP)
        mapper.RenderToImageOn()
        with renderers() as renderer:
            renderer.AddVolume(volume_of(mapper, look(), nothing))
            look_at(renderer, (30, 20, 1.3))
            render()
            color, depth = vtk.vtkImageData(), vtk.vtkImageData()
            mapper.GetColorImage(color), mapper.GetDepthImage(depth)
            colors.append(vtk_to_numpy(color.GetPointData().GetScalars()).reshape(SIZE[1], SIZE[0], 4).astype(int))
            depths.append(255.0 * vtk_to_numpy(depth.GetPointData().GetScalars()).reshape(SIZE[1], SIZE[0]))
    return tuple(colors), tuple(depths)


@case("TestGPURayCastRenderToTexture")
def colours_to_image():
    """Where no ray meets the box, VTK's image is white and ours is clear."""
    vtks, ours = to_images()[0]
    seen = ours[..., 3] > 0
    return Different([(vtks, ours)], [(vtks[seen], ours[seen])])


@case("TestGPURayCastRenderDepthToImage")
def depths_to_image():
    return Same(to_images()[1])


def with_shader(volume):
    volume.GetShaderProperty().AddFragmentShaderReplacement("//VTK::Base::Impl", True, "//VTK::Base::Impl\n", False)


@case("TestGPURayCastUserShader", "TestGPURayCastUserShader2")
def own_shader():
    return refusal(image(), look(), place=with_shader)


def picked(kind, picker, data, shown, settings=nothing):
    """The places in the volume, as i, j, k and one more that says whether it was hit, of a grid of picks."""
    mapper = kind()
    mapper.SetInputDataObject(data)
    fine(mapper, STEP)
    settings(mapper)
    found = numpy.zeros((11, 11, 4))
    with renderers() as renderer:
        renderer.AddVolume(volume_of(mapper, shown, nothing))
        look_at(renderer, (30, 20, 1.3))
        render()
        for row in range(11):
            for column in range(11):
                hit = picker.Pick(SIZE[0] * (column + 0.6) / 11, SIZE[1] * (row + 0.4) / 11, 0, renderer)
                found[row, column] = (*picker.GetPickPosition(), 10) if hit else (0, 0, 0, 0)
    return found


def picks(settings=nothing):
    """Places that VTK's picker finds in FixedPoint's volume, compared with the places that it and ours find in ours."""
    pickers = []
    for kind in vtk.vtkVolumePicker, vtk.vtkVolumePicker, stratus.vtkStratusVolumePicker:
        pickers.append(kind())
        pickers[-1].SetVolumeOpacityIsovalue(0.05)
    first, *others = (picked(mapper, picker, image(), look(), settings) for mapper, picker in zip((FIXED, OURS, OURS), pickers))
    return Same(*((first, other) for other in others))


@case("VolumePicker")
def picker():
    return picks()


@case("VolumePickerCrop")
def picker_crop():
    def settings(mapper):
        mapper.CroppingOn()
        mapper.SetCroppingRegionPlanes(0, 30, 0, 39, 0, 27)
        planes(((19, 19, 19), (0, 1, 0)))(mapper)

    return picks(settings)


@case("TestGPURayCastVolumePicking")
def hardware_picking():
    """What a hardware selector finds at every third pixel that shows something, by more than 2 of 255: nothing, the volume, the surface."""
    pictures, shown = [], None
    for kind in GPU, OURS:
        mapper = kind()
        mapper.SetInputDataObject(image())
        fine(mapper, STEP)
        with renderers() as renderer:
            volume, actor = volume_of(mapper, look(), nothing), sphere((30, 30, 30), 5)
            renderer.AddVolume(volume), renderer.AddActor(actor)
            look_at(renderer, (30, 20, 1.3))
            render()
            if shown is None:
                shown = abs(pixels()[::3, ::3] - 255 * numpy.array(BACKGROUND)).max(-1) > 2.5
            selector, props = vtk.vtkHardwareSelector(), numpy.zeros(shown.shape, int)
            selector.SetRenderer(renderer)
            selector.SetArea(0, 0, SIZE[0] - 1, SIZE[1] - 1)
            selector.CaptureBuffers()
            for row, column in numpy.ndindex(*shown.shape):
                selection = selector.GenerateSelection(3 * column, 3 * row, 3 * column, 3 * row)
                if selection.GetNumberOfNodes():
                    prop = selection.GetNode(0).GetProperties().Get(vtk.vtkSelectionNode.PROP())
                    props[row, column] = {volume: 1, actor: 2}[prop]
            pictures.append(100 * numpy.where(shown, props, 0))
    return Same(tuple(pictures))


@case("TestRemoveVolumeNonCurrentContext")
def removed_elsewhere():
    """The volume leaves the renderer while another window's context is current, and then comes back."""
    pictures = []
    for kind in GPU, stratus.vtkStratusVolumeMapper:
        mapper = kind()
        mapper.SetInputDataObject(image())
        fine(mapper, STEP)
        with renderers() as renderer:
            volume = volume_of(mapper, look(), nothing)
            renderer.AddVolume(volume)
            look_at(renderer, (30, 20, 1.3))
            render()
            other = vtk.vtkRenderWindow()
            other.SetOffScreenRendering(1)
            other.SetSize(64, 64)
            other.AddRenderer(vtk.vtkRenderer())
            other.Render()
            renderer.RemoveVolume(volume)
            render()
            renderer.AddVolume(volume)
            render()
            pictures.append(pixels())
            other.Finalize()
    return Same(tuple(pictures))


@case("TestGPURayCastImageSampleXY")
def coarse_picture():
    def settings(mapper):
        mapper.SetImageSampleDistance(4)

    return Different([pair(image(), look(shade=True), settings)], [pair(image(), look(shade=True))])


@case("TestGPURayCastMultiVolumeClipping")
def several_clipped():
    def cut(mapper):
        planes(((19, 19, 19), (0.4, 0.5, -1)))(mapper)

    return Same(several([(image(), look(), nothing), (image(made.ball(30)), red(), moved)], settings=cut))


@case("TestGPURayCastRenderDepthToImage2")
def clamped_depths():
    return Same(to_images()[1])
