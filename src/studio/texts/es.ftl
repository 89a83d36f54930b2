# Las palabras que muestra Studio. Las mismas claves están en en.ftl.

window-title = Ademán Studio

## Barra de herramientas

button-pause = Pausar
button-resume = Reanudar
button-recenter = Recentrar
button-zero = Poner a cero
hint-pause = Suelta todas las teclas y no envía nada más, o continúa (P)
hint-recenter = Coloca los tableros bajo la punta del índice (C)
hint-zero = Relaje antes la mano: sus ángulos actuales pasan a ser los de reposo (Z)
menu-view = Vista
view-eye = Desde los ojos
view-above = Desde arriba
view-side = De lado
view-bones = Huesos y articulaciones
view-dark = Oscuro
panel-sensors = Sensores
panel-scope = Osciloscopio

## Vista 3D

hint-camera = arrastrar: girar · botón derecho: desplazar · rueda: acercar · 1 2 3: vistas

## Sensores

channel-column = Canal
channel-joint = Articulación
channel-count = Valor
channel-angle = Ángulo
channel-at-end = En el extremo de su rango
channel-unchanged = Sin cambios desde hace 10 s
channel-none = Esta fuente no tiene canales: mide ángulos o posiciones.
channel-no-reading = Aún no ha llegado ninguna lectura.
stats-source = Fuente
stats-output = Salida
stats-rate = Lecturas por segundo
stats-accepted = Aceptadas
stats-dropped = Descartadas
stats-losses = Desconexiones
stats-stalls = Interrupciones

## Osciloscopio

scope-presses = Pulsaciones
scope-lowest-fingertip = Punta más baja sobre el tablero

## Línea de estado

message-ended = La sesión ha terminado. No queda ninguna tecla pulsada.
