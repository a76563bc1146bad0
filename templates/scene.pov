// {{ title }}
// A scene that shows off {{ stem }}.inc. Render it with: povray {{ stem }}.ini
// Made by lichtenberg {{ version }}. Edit it freely: an edited file is not overwritten.
#version 3.7;

// Two looks: studio (soft sun, light from the whole sky), and exact (sharp shadows, constant ambient light; fast).
#ifndef({{ prefix }}_Exact) #declare {{ prefix }}_Exact = 0; #end

global_settings {
  assumed_gamma 1.0
#if (!{{ prefix }}_Exact) ambient_light 0 #end
}

camera {
  {{ camera.kind }}
  location {{ camera.location }}
{% if camera.angle %}
  right x*image_width/image_height
  angle {{ camera.angle }}
{% else %}
  right x*{{ camera.width }}
  up y*{{ camera.width }}*image_height/image_width
{% endif %}
  look_at {{ camera.look_at }}
}
{% for light in lights %}
#if ({{ prefix }}_Exact)
light_source {
  {{ light.location }}, rgb {{ light.colour }}
{% if light.parallel %}
  parallel point_at <0, 0, 0>
{% endif %}
{% if light.fade %}
  fade_distance {{ light.fade }} fade_power 2
{% endif %}
{% if not light.shadow %}
  shadowless
{% endif %}
}
{% if light.shadow or light.fade %}
#else
light_source {
  {{ light.location }}, rgb {{ light.studio }}
{% if light.parallel %}
  parallel point_at <0, 0, 0>
{% endif %}
{% if light.fade %}
  fade_distance {{ light.fade }} fade_power 2
{% endif %}
{% if not light.shadow %}
  shadowless
{% endif %}
{% if light.across %}
  area_light x*{{ light.across }}, z*{{ light.across }}, 5, 5 adaptive 1 circular orient
{% endif %}
}
{% endif %}
#end
{% endfor %}
#if (!{{ prefix }}_Exact)
// The sky, and what comes back from the ground, as {{ dome|length }} lights: directions and colours.
#declare {{ prefix }}_Dome = array[{{ dome|length }}][2] {
{% for light in dome %}
  { {{ light[0] }}, {{ light[1] }} }{% if not loop.last %},{% endif %}

{% endfor %}
}
#for (I, 0, {{ dome|length - 1 }})
  light_source { {{ prefix }}_Dome[I][0]*{{ extent }}, rgb {{ prefix }}_Dome[I][1] parallel point_at <0, 0, 0> }
#end
#end
sky_sphere {
  pigment {
{% if sky.zenith %}
    gradient y
    color_map { [0.5 rgb {{ sky.horizon }}] [1 rgb {{ sky.zenith }}] }
    scale 2 translate -1
{% else %}
    image_map { exr "{{ stem }}-sky.exr" map_type 1 interpolate 2 }
    rotate {{ sky.turn }}*y
{% endif %}
  }
}
{% if ground %}
{% if ground.radius %}
disc {
  <0, {{ ground.height }}, 0>, y, {{ ground.radius }}
  texture { pigment { rgb {{ ground.colour }} } finish { ambient {{ ground.ambient }} diffuse {{ ground.diffuse }} } }
{% else %}
// The ground fades into the horizon.
plane {
  y, {{ ground.height }}
  texture {
    spherical
    texture_map {
      [0 pigment { rgb {{ sky.horizon }} } finish { ambient 0 diffuse 0 emission 1 }]
      [{{ ground.fade }} pigment { rgb {{ ground.colour }} } finish { ambient {{ ground.ambient }} diffuse {{ ground.diffuse }} }]
    }
    scale {{ ground.reach }}
  }
{% endif %}
  no_shadow
}
{% endif %}
{% if inline %}
#declare {{ prefix }}_Inline = yes;
{% endif %}
#include "{{ stem }}.inc"
{% if not inline %}
{% for object in objects %}
object { {{ object.id }} translate {{ object.id }}_Foot }
{% for place in object.places %}
object { {{ object.id }} {{ place }} }
{% endfor %}
{% endfor %}
{% endif %}
