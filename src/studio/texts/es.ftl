# Las palabras que muestra Studio. Las mismas claves están en en.ftl.

window-title = Ademán Studio

## Barra de herramientas

button-pause = Pausar
button-resume = Reanudar
button-recenter = Recentrar
button-zero = Poner a cero
hint-pause = Suelta todas las teclas y deja de enviar, o reanuda la sesión
hint-recenter = Coloca los tableros bajo la punta del índice
hint-zero = Relaje antes la mano: sus ángulos actuales pasan a ser los de reposo
hint-view = Cambia la vista 3D
hint-panel = Muestra u oculta este panel
menu-view = Vista
view-eye = Desde los ojos
view-above = Desde arriba
view-side = De lado
view-bones = Huesos y articulaciones
view-trails = Estelas de las yemas
view-reach = Alcance
menu-settings = Ajustes
menu-help = Ayuda
theme-system = Colores del sistema
theme-light = Claro
theme-dark = Oscuro
theme-contrast = Alto contraste
scale-larger = Más grande (Ctrl+Más)
scale-smaller = Más pequeño (Ctrl+Menos)
scale-normal = Tamaño normal (Ctrl+0)
panel-sensors = Sensores
panel-scope = Osciloscopio
panel-space = Vista 3D
panel-toolbar = Barra de herramientas
panel-word = Panel

## Ayuda

help-tour = Visita guiada
help-guide = La guía viene con el código fuente:
keys-title = Teclas
keys-next-panel = Panel siguiente
keys-previous-panel = Panel anterior
keys-tab = Control siguiente o anterior
keys-operate = Accionar el control seleccionado
keys-escape = Cerrar un menú o una ventana
keys-scale = Más grande, más pequeño
keys-normal-scale = Tamaño normal

## Visita guiada

tour-step = Paso { $step } de { $count }
tour-next = Siguiente
tour-back = Atrás
tour-skip = Saltar la visita
tour-done = Terminar
tour-view = La mano y sus tableros
tour-view-words = La vista 3D muestra la mano tal como Ademán la interpreta. Un anillo sobre el tablero se encoge cuando se acerca un dedo, y la tecla pulsada se hunde y se ilumina. Arrastre para girar, use la rueda para acercarse o pulse 1, 2 o 3.
tour-pause = Pausar en cualquier momento
tour-pause-words = El primer botón, o la tecla P, suelta todas las teclas y no envía nada hasta que reanude. Para pausar desde cualquier programa, indique teclas de emergencia en su archivo de configuración, por ejemplo las dos teclas Ctrl: panic_keys: ["ControlLeft", "ControlRight"].
tour-sensors = Sensores
tour-sensors-words = El panel de la derecha muestra cada sensor y el ángulo que mide. Una marca ! avisa de un cable roto o de un sensor bloqueado. Si los ángulos no siguen a su mano, calibre el guante: ademan calibrate.
tour-layout = Su propia distribución
tour-layout-words = Los teclados, paneles e instrumentos son archivos de texto. Copie uno con ademan layout new, edítelo y ábralo con ademan studio --layout ARCHIVO: la vista se actualiza cada vez que lo guarda.
tour-output = Conectar una salida con seguridad
tour-output-words = No se escribe nada en otros programas hasta que un archivo de configuración indique una salida. La línea inferior siempre dice cuál es. Pruebe primero aquí la distribución, compruebe la pausa y las teclas de emergencia, y ejecute ademan doctor antes de conectar una.

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

scope-angles = Ángulos
scope-rows = Filas
scope-heights = Altura de las yemas
scope-latency = Latencia
scope-presses = Pulsaciones por dedo
scope-events = Teclas enviadas
scope-hold = Congelar la gráfica
scope-latest = Últimos 30 s
scope-hint = rueda: ampliar · arrastrar: mover · doble clic: últimos 30 s
scope-plot = Gráfica de ángulos, yemas y pulsaciones en el tiempo

## Línea de estado

state-starting = Iniciando
state-running = En marcha
state-paused = En pausa
state-stalled = Sin lecturas
state-stopped = Terminada
typing-nowhere = No se escribe nada en otros programas
typing-suppressed = En pausa: por ahora no se escribe nada en otros programas
typing-into = Escribe en otros programas: { $output }

message-ended = La sesión ha terminado. No queda ninguna tecla pulsada.

## Grabación

recording-play = Reproducir
recording-pause = Pausa
recording-first = Primera lectura
recording-back = Una lectura atrás
recording-on = Una lectura adelante
recording-last = Última lectura
recording-position = Posición
recording-speed = Velocidad
recording-hint = Izquierda, derecha: una lectura; con Mayús: 1 s; Inicio, Fin; Espacio: reproducir o pausar
recording-step = lectura { $index } de { $count }
recording-loading = Leyendo la grabación: { $count } lecturas hasta ahora
recording-cut = La grabación no está completa: { $reason }. Se muestra todo lo anterior.
recording-part = Fragmento
recording-from = Desde aquí
recording-to = Hasta aquí
recording-file = Archivo
recording-export = Exportar el fragmento
recording-exporting = Escribiendo…
recording-exported = { $count } lecturas están en { $file }
recording-replace = { $file } ya existe.
recording-replace-yes = Reemplazarlo
recording-replace-no = Conservarlo
recording-compare = Comparar con la distribución
recording-compare-go = Comparar
recording-compare-close = Cerrar
recording-comparing = Comparando…
recording-same = iguales: { $count }
recording-only-a = solo A: { $count }
recording-only-b = solo B: { $count }
recording-rows = Pulsaciones de ambas distribuciones a lo largo de la grabación; un clic va a ese momento
